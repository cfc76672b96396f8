#include "render/generations.h"

#include <algorithm>

#include "geometry/geometry.h"

namespace etendue {

bool asks_for(const RenderSettings& settings, Use technique) {
  if (settings.integrator == IntegratorKind::automatic) return technique != Use::off;
  return settings.integrator == IntegratorKind::path && technique == Use::on;
}

bool uses(const RenderSettings& settings, Use technique) {
  return settings.max_depth >= 2 && asks_for(settings, technique);
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
