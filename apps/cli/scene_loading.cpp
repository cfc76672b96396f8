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
bool shines(const scene::EnvironmentLight& light) {
  return light.intensity > 0;
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

bool has_light(const scene::SceneDescription& scene) {
  const auto light_shines = [](const scene::Light& light) {
    return std::visit([](const auto& source) { return shines(source); }, light.source);
  };
  const auto emits = [&](const scene::Instance& instance) {
    return scene::emits(scene.materials[instance.material.index]);
  };
  return std::ranges::any_of(scene.lights, light_shines) || std::ranges::any_of(scene.instances, emits);
}

}  // namespace etendue
