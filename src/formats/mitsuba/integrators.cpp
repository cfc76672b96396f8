#include "formats/mitsuba/integrators.h"

#include <fmt/format.h>

#include <algorithm>

namespace etendue::mitsuba {
namespace {

constexpr std::string_view kWrappers[] = {"aov", "moment", "stokes"};
constexpr std::string_view kPathTracers[] = {"path", "prb", "prb_basic", "prb_projective", "ptracer"};
constexpr std::string_view kDirect[] = {"direct", "direct_projective"};
constexpr std::string_view kVolumeTracers[] = {"prbvolpath", "volpath", "volpathmis"};

bool is_among(std::string_view type, const auto& types) {
  return std::find(std::begin(types), std::end(types), type) != std::end(types);
}

/// Mitsuba counts vertices, −1 stands for any number; we count bounces.
void read_depth(Properties& properties, scene::RenderHints& hints) {
  const int depth = properties.integer("max_depth", -1, -1, 1 << 30);
  if (depth == 0)
    properties.report().warning("with a max_depth of 0 nothing would be seen; 1 is used",
                                properties.find("max_depth")->where);
  if (depth >= 0) hints.max_depth = std::max(depth, 1) - 1;
}

/// What says how an integrator works, not what it computes.
void ignore_technicalities(Properties& properties) {
  properties.ignore({"block_size", "emitter_samples", "bsdf_samples", "rr_depth", "samples_per_pass", "shading_samples",
                     "timeout", "use_spectral_mis"});
  if (properties.object().is_old) properties.ignore({"strict_normals"});
}

}  // namespace

Integrator read_integrator(const Document& document, const Element& element, Report& report) {
  Properties properties(document, element, report);
  const std::string_view type = element.type();
  if (is_among(type, kWrappers))
    if (const std::vector<const Element*> inner = properties.objects("integrator"); !inner.empty()) {
      properties.ignore({"aovs"});
      ignore_technicalities(properties);
      properties.reject_unread();
      return read_integrator(document, *inner.front(), report);
    }

  scene::RenderHints hints;
  const bool is_volume = is_among(type, kVolumeTracers), is_direct = is_among(type, kDirect);
  const bool is_known = is_volume || is_direct || is_among(type, kPathTracers);
  if (!is_known)
    report.warning(fmt::format("the integrator {} is not known here; \"path\" is used", in_quotes(type)),
                   element.where);
  hints.null_counts_as_bounce = !is_volume;
  hints.hide_emitters = properties.boolean("hide_emitters", false);
  if (is_direct)
    hints.max_depth = 1;
  else
    read_depth(properties, hints);
  ignore_technicalities(properties);
  if (is_known) properties.reject_unread();
  return {hints, is_volume || !is_known};
}

}  // namespace etendue::mitsuba
