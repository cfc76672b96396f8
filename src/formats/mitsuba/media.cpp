#include "formats/mitsuba/media.h"

#include <fmt/format.h>

namespace etendue::mitsuba {
namespace {

scene::Phase read_phase(const Document& document, const Element& element, Report& report) {
  Properties properties(document, element, report);
  scene::Phase phase = scene::IsotropicPhase{};
  if (element.type() == "hg") {
    phase = scene::HenyeyGreensteinPhase{properties.number("g", 0.8f, -0.9999f, 0.9999f)};
  } else if (element.type() != "isotropic") {
    report.warning(fmt::format("the phase function {} is not known here; isotropic is used", in_quotes(element.type())),
                   element.where);
    return phase;
  }
  properties.reject_unread();
  return phase;
}

/// σs and σa, as version 0.6 wrote them, in place of σt and albedo.
void read_scattering_and_absorption(Properties& properties, VolumeLibrary& volumes, scene::Medium& medium) {
  const scene::VolumeInput s = volumes.input(properties, "sigma_s", 0), a = volumes.input(properties, "sigma_a", 0);
  const auto *scattering = std::get_if<Spectrum>(&s), *absorption = std::get_if<Spectrum>(&a);
  if (scattering == nullptr || absorption == nullptr)
    throw Problem("sigma_s and sigma_a cannot vary in space; write sigma_t and albedo", properties.where());
  const Spectrum total = *scattering + *absorption;
  Spectrum albedo;
  for (int i = 0; i < 3; ++i) albedo[i] = total[i] > 0 ? (*scattering)[i] / total[i] : 0;
  medium.sigma_t = total;
  medium.albedo = albedo;
}

}  // namespace

std::optional<scene::Id<scene::Medium>> MediumLibrary::named(Properties& properties, std::string_view name) {
  const Element* element = properties.find(name);
  if (element == nullptr) return std::nullopt;
  return medium(properties.document(), *element, properties.report());
}

std::optional<scene::Id<scene::Medium>> MediumLibrary::only(Properties& properties) {
  const Element* element = properties.object("medium");
  if (element == nullptr) return std::nullopt;
  return medium(properties.document(), *element, properties.report());
}

std::optional<scene::Id<scene::Medium>> MediumLibrary::medium(const Document& document, const Element& element,
                                                              Report& report) {
  if (const auto known = known_.find(&element); known != known_.end()) return known->second;
  std::optional<scene::Id<scene::Medium>> id;
  try {
    if (auto medium = read(document, element, report)) {
      id = {static_cast<std::uint32_t>(scene_.media.size())};
      scene_.media.push_back(*std::move(medium));
    }
  } catch (const Problem& problem) {
    report.error(problem);
  }
  known_[&element] = id;
  return id;
}

std::optional<scene::Medium> MediumLibrary::read(const Document& document, const Element& element, Report& report) {
  if (element.tag != "medium") throw Problem(fmt::format("a <{}> is not a <medium>", element.tag), element.where);
  if (element.type() != "homogeneous" && element.type() != "heterogeneous") {
    report.warning(fmt::format("the medium {} is not known here; it is left out", in_quotes(element.type())),
                   element.where);
    return std::nullopt;
  }
  Properties properties(document, element, report);
  scene::Medium medium;
  medium.name = properties.name();
  medium.where = element.where;
  const bool has_parts = properties.has("sigma_s") || properties.has("sigma_a");
  if (has_parts && (properties.has("sigma_t") || properties.has("albedo")))
    throw Problem("a medium has either sigma_t and albedo, or sigma_s and sigma_a", element.where);
  if (has_parts) {
    read_scattering_and_absorption(properties, volumes_, medium);
  } else {
    medium.sigma_t = element.type() == "heterogeneous" ? volumes_.extinction(properties, "sigma_t", 1)
                                                       : volumes_.input(properties, "sigma_t", 1);
    medium.albedo = volumes_.input(properties, "albedo", 0.75f);
  }
  medium.scale = properties.number("scale", 1, 0, 3e38f);
  if (const Element* phase = properties.object("phase")) medium.phase = read_phase(document, *phase, report);
  properties.ignore({"has_spectral_extinction", "sample_emitters"});
  properties.reject_unread();
  return medium;
}

}  // namespace etendue::mitsuba
