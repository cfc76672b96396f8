#include "render/generations.h"

#include <algorithm>

#include "geometry/geometry.h"

namespace etendue {

bool uses(const RenderSettings& settings, Use technique) {
  if (settings.max_depth < 2 || technique == Use::off) return false;
  return settings.integrator == IntegratorKind::automatic ||
         (settings.integrator == IntegratorKind::path && technique == Use::on);
}

std::uint32_t usual_generation_size(const RenderSettings& settings) {
  constexpr std::uint64_t kFewestPixels = 1 << 14;
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  return static_cast<std::uint32_t>((kFewestPixels + pixels - 1) / pixels) * Geometry::kBatch;
}

std::uint32_t worthwhile_samples(const RenderSettings& settings) {
  const std::uint32_t size = usual_generation_size(settings);
  if (settings.for_denoising) return size;
  return std::clamp(static_cast<std::uint32_t>(settings.samples_per_pixel), size / 4, size);
}

std::uint64_t photon_memory(const RenderSettings& settings) {
  return settings.memory_limit / (settings.for_denoising ? 2 : 1) / 8 * 5;
}

std::uint64_t record_memory(const RenderSettings& settings) {
  return settings.memory_limit / (settings.for_denoising ? 2 : 1) / 8 * 3;
}

}  // namespace etendue
