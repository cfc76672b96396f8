#include "scene_loading.h"

#include <algorithm>

#include "base/log.h"

namespace etendue {
namespace {

bool shines(const scene::PointLight& light) {
  return !light.intensity.is_black();
}
bool shines(const scene::SpotLight& light) {
  return !light.intensity.is_black();
}
bool shines(const scene::DirectionalLight& light) {
  return !light.irradiance.is_black();
}
bool shines(const scene::RectangleLight& light) {
  return !light.radiance.is_black();
}
bool shines(const scene::HemisphereLight& light) {
  return !light.radiance.is_black();
}
bool shines(const scene::ConstantLight& light) {
  return !light.radiance.is_black();
}
bool shines(const scene::ProjectorLight& light) {
  return light.scale > 0;
}
bool shines(const scene::EnvironmentLight& light) {
  return light.intensity > 0;
}

bool light_shines(const scene::Light& light) {
  return std::visit([](const auto& source) { return shines(source); }, light.source);
}

bool has_extent(const scene::Light& light) {
  return !std::holds_alternative<scene::PointLight>(light.source) &&
         !std::holds_alternative<scene::SpotLight>(light.source) &&
         !std::holds_alternative<scene::ProjectorLight>(light.source) &&
         !std::holds_alternative<scene::DirectionalLight>(light.source);
}

}  // namespace

void DiagnosticsPrinter::print() {
  const auto& all = diagnostics_.all();
  for (; printed_ < all.size(); ++printed_) {
    const Diagnostic& diagnostic = all[printed_];
    if (diagnostic.severity == Severity::warning) log_warning(diagnostics_.format(diagnostic));
    if (diagnostic.severity == Severity::info) log_info(diagnostics_.format(diagnostic));
  }
}

bool emits(const scene::SceneDescription& scene, const scene::Instance& instance) {
  return !std::holds_alternative<scene::Id<scene::Group>>(instance.shape) &&
         scene::emits(scene.materials[instance.material.index]);
}

bool has_light(const scene::SceneDescription& scene) {
  return has_light_with_extent(scene) || std::ranges::any_of(scene.lights, light_shines);
}

bool has_light_with_extent(const scene::SceneDescription& scene) {
  return std::ranges::any_of(scene.lights,
                             [](const auto& light) { return has_extent(light) && light_shines(light); }) ||
         std::ranges::any_of(scene.instances, [&](const auto& instance) { return emits(scene, instance); });
}

}  // namespace etendue
