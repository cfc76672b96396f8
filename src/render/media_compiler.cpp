#include "render/media_compiler.h"

#include <algorithm>
#include <map>

namespace etendue {
namespace {

/// Nearer to ±1 the phase function is a spike that floats cannot follow.
constexpr float kMaxMeanCosine = 0.999f;

class MediaCompiler {
 public:
  MediaCompiler(const scene::SceneDescription& scene, Diagnostics& diagnostics)
      : scene_(scene), diagnostics_(diagnostics) {}

  std::vector<Medium> run() {
    std::vector<Medium> media;
    for (const scene::Medium& medium : scene_.media) media.push_back(compile(medium));
    return media;
  }

 private:
  Medium compile(const scene::Medium& medium) {
    if (!(medium.scale >= 0) || std::isinf(medium.scale))
      diagnostics_.repaired("scale of a medium that is negative or not finite brought to what is near", medium.where);
    check(medium.sigma_t, std::numeric_limits<float>::max(),
          "extinction of a medium that is negative or not finite brought to what is near", medium.where);
    check(medium.albedo, 1, "albedo of a medium outside 0 to 1 brought there", medium.where);
    Medium compiled(volume(medium.sigma_t), medium.scale, volume(medium.albedo),
                    std::visit([&](const auto& p) { return phase(p, medium.where); }, medium.phase));
    if (const auto* id = std::get_if<scene::Id<scene::Volume>>(&medium.sigma_t)) {
      const Volume& grid = volumes_.at(id->index);
      if (grid.range(grid.bounds()).max * medium.scale > compiled.max_extinction())
        diagnostics_.repaired(
            "medium so dense that light gets no further than 1/100000 of its size made as dense as that", medium.where);
    }
    return compiled;
  }

  /// Counts what does not lie between 0 and `most`: the medium repairs it where it is looked up.
  void check(const scene::VolumeInput& input, float most, std::string_view message, SourceLocation where) {
    const auto is_bad = [most](float value) { return !(value >= 0 && value <= most); };
    if (const Spectrum* constant = std::get_if<Spectrum>(&input)) {
      diagnostics_.repaired(message, where, is_bad(constant->r) || is_bad(constant->g) || is_bad(constant->b) ? 1 : 0);
      return;
    }
    const scene::Volume& volume = scene_.volumes[std::get<scene::Id<scene::Volume>>(input).index];
    if (const auto* grid = std::get_if<scene::GridVolume>(&volume.source))
      diagnostics_.repaired(message, where, static_cast<std::uint64_t>(std::ranges::count_if(grid->values, is_bad)));
  }

  Volume volume(const scene::VolumeInput& input) {
    if (const Spectrum* constant = std::get_if<Spectrum>(&input)) return Volume(*constant);
    const std::uint32_t index = std::get<scene::Id<scene::Volume>>(input).index;
    if (const auto known = volumes_.find(index); known != volumes_.end()) return known->second;
    return volumes_.emplace(index, placed(scene_.volumes[index])).first->second;
  }

  Volume placed(const scene::Volume& description) {
    const float extent = description.to_world.determinant();
    if (std::isfinite(extent) && extent != 0 && is_finite(description.to_world.origin)) return Volume(description);
    diagnostics_.repaired("volume without extent left out", description.where);
    return Volume(Spectrum(0));
  }

  Phase phase(const scene::IsotropicPhase&, SourceLocation) { return IsotropicPhase{}; }
  Phase phase(const scene::HenyeyGreensteinPhase& p, SourceLocation where) {
    if (std::abs(p.g) <= kMaxMeanCosine) return HenyeyGreensteinPhase{p.g};
    diagnostics_.repaired("mean cosine of a phase function outside −0.999 to 0.999 brought there", where);
    return HenyeyGreensteinPhase{std::isnan(p.g) ? 0 : std::copysign(kMaxMeanCosine, p.g)};
  }

  const scene::SceneDescription& scene_;
  Diagnostics& diagnostics_;
  std::map<std::uint32_t, Volume> volumes_;
};

}  // namespace

std::vector<Medium> compile_media(const scene::SceneDescription& scene, Diagnostics& diagnostics) {
  return MediaCompiler(scene, diagnostics).run();
}

}  // namespace etendue
