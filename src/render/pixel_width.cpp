#include "render/pixel_width.h"

#include <algorithm>
#include <vector>

#include "render/vertex.h"
#include "sampling/sampler.h"

namespace etendue {
namespace {

/// In place of a pixel's row, which no picture reaches: random numbers of its own.
constexpr std::uint32_t kRow = 0xffff'fff1u;

}  // namespace

float usual_pixel_width(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings) {
  constexpr int kRays = 32, kMirrors = 12;
  if (camera.projection != Projection::perspective && camera.projection != Projection::orthographic) return 0;
  const float per_metre = 2 * camera.tan_half_x / static_cast<float>(settings.width);
  std::vector<float> widths;
  for (std::uint32_t i = 0; i < kRays * kRays; ++i) {
    const PixelSampler sampler(SamplerKind::independent, 0, i, kRow);
    const std::uint32_t column = i % kRays, row = i / kRays;
    Ray ray = generate_ray(
        camera, Vec2(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f) * (1.0f / kRays), {0.5f, 0.5f});
    float way = 0;
    for (std::uint32_t bounce = 0; bounce < kMirrors; ++bounce) {
      const RayHit hit = scene.geometry.intersect(ray);
      if (!hit.found()) break;
      way += hit.t;
      const Vertex vertex(scene, ray, hit);
      if (!vertex.scattering.is_delta()) {
        widths.push_back(camera.projection == Projection::perspective ? per_metre * way : per_metre);
        break;
      }
      const auto sample = vertex.scattering.sample(sampler.point(bounce, 0), sampler.point(bounce, 1).x);
      if (!sample) break;
      ray = {offset_origin(vertex.surface, sample->wi), sample->wi};
    }
  }
  if (widths.empty()) return 0;
  const auto quarter = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 4);
  std::nth_element(widths.begin(), quarter, widths.end());
  return *quarter;
}

}  // namespace etendue
