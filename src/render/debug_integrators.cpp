#include "render/debug_integrators.h"

#include "math/frame.h"
#include "render/dimensions.h"
#include "render/vertex.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

/// How far ambient occlusion looks, as a share of the scene's diagonal.
constexpr float kOcclusionReach = 0.25f;

}  // namespace

std::uint64_t DebugIntegrator::estimate(const PixelBlock& block, std::uint32_t first, int count,
                                        std::span<PixelSample> samples) const {
  const PixelSampler sampler(settings_.sampler, settings_.seed, static_cast<std::uint32_t>(block.x),
                             static_cast<std::uint32_t>(block.y),
                             static_cast<std::uint32_t>(settings_.samples_per_pixel));
  Ray rays[Geometry::kBatch];
  RayHit hits[Geometry::kBatch];
  const std::span<const Ray> starting(rays, samples.size());
  camera_rays_.generate(sampler, block.x, block.y, first, std::span(rays, samples.size()), samples);
  scene_.geometry.intersect_coherent(starting, std::span(hits, samples.size()));
  float u[Geometry::kBatch], v[Geometry::kBatch];
  sampler.points(dimension::at(0, dimension::kDirection), first, count, u, v);
  std::uint64_t traced = samples.size();
  for (int i = 0; i < count; ++i) {
    if (!hits[i].found()) continue;
    const Vertex vertex(scene_, rays[i], hits[i]);
    camera_rays_.describe(rays[i], vertex.surface, samples[i]);
    samples[i].albedo = vertex.scattering.albedo();
    const Vec3 n = samples[i].normal;
    if (settings_.integrator == IntegratorKind::albedo) {
      samples[i].radiance = samples[i].albedo;
    } else if (settings_.integrator == IntegratorKind::normals) {
      samples[i].radiance = Spectrum(n.x + 1, n.y + 1, n.z + 1) * 0.5f;
    } else {
      const Vec3 direction = Frame::from_normal(n).to_world(sample_hemisphere_cosine({u[i], v[i]}));
      Ray ray{offset_origin(vertex.surface, direction), direction};
      ray.t_max = kOcclusionReach * scene_.geometry.bounds().diagonal();
      ++traced;
      samples[i].radiance = Spectrum(scene_.geometry.occluded(std::span(&ray, 1)) == 0 ? 1.0f : 0.0f);
    }
  }
  return traced;
}

}  // namespace etendue
