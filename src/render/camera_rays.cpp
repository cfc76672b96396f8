#include "render/camera_rays.h"

#include "render/dimensions.h"

namespace etendue {

CameraRays::CameraRays(const Camera& camera, const RenderSettings& settings)
    : camera_(camera), filter_(settings.filter), width_(settings.width), height_(settings.height) {}

void CameraRays::generate(const PixelSampler& sampler, int x, int y, std::uint32_t first, std::span<Ray> rays,
                          std::span<PixelSample> samples) const {
  constexpr int kBatch = Geometry::kBatch;
  const int count = static_cast<int>(rays.size());
  float fu[kBatch], fv[kBatch], lu[kBatch], lv[kBatch];
  sampler.points(dimension::kFilm, first, count, fu, fv);
  const bool has_lens = camera_.lens_radius > 0;
  if (has_lens) sampler.points(dimension::kLens, first, count, lu, lv);
  for (int i = 0; i < count; ++i) {
    samples[i] = {};
    const PixelFilter::Sample at = filter_.sample({fu[i], fv[i]});
    const Vec2 film((static_cast<float>(x) + 0.5f + at.offset.x) / static_cast<float>(width_),
                    (static_cast<float>(y) + 0.5f + at.offset.y) / static_cast<float>(height_));
    rays[i] = generate_ray(camera_, film, has_lens ? Vec2(lu[i], lv[i]) : Vec2(0.5f));
    samples[i].weight = at.weight;
  }
}

void CameraRays::describe(const Ray& ray, const RayHit& hit, const SurfaceHit& surface, PixelSample& sample) const {
  sample.depth = -dot(ray.direction, camera_.to_world.z) * hit.t;
  sample.normal = dot(surface.shading_normal, ray.direction) > 0 ? -surface.shading_normal : surface.shading_normal;
}

}  // namespace etendue
