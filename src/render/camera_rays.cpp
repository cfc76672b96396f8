#include "render/camera_rays.h"

#include "math/frame.h"
#include "render/dimensions.h"
#include "sampling/warp.h"

namespace etendue {

namespace {

struct WeightedRay {
  Ray ray;
  float weight;
};

/// The mean irradiance of a surface is 1/A ∫∫ L cos θ dω dA: points by area, directions with density cos θ / π.
WeightedRay leave(const AreaSampler& surface, Vec2 place, float choice, Vec2 direction) {
  const AreaPoint from = surface.sample(place, choice);
  const Vec3 w = Frame::from_normal(from.surface.geometric_normal).to_world(sample_hemisphere_cosine(direction));
  return {{offset_origin(from.surface, w), w}, kPi / (from.pdf_area * surface.area())};
}

}  // namespace

CameraRays::CameraRays(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings)
    : scene_(scene), camera_(camera), filter_(settings.filter), width_(settings.width), height_(settings.height) {}

void CameraRays::generate(const PixelSampler& sampler, int x, int y, std::uint32_t first, std::span<Ray> rays,
                          std::span<PixelSample> samples) const {
  constexpr int kBatch = Geometry::kBatch;
  const int count = static_cast<int>(rays.size());
  float fu[kBatch], fv[kBatch], lu[kBatch], lv[kBatch];
  sampler.points(dimension::kFilm, first, count, fu, fv);
  const bool measures = camera_.projection == Projection::irradiance && scene_.measured;
  const bool has_lens = camera_.lens_radius > 0 || measures;
  if (has_lens) sampler.points(dimension::kLens, first, count, lu, lv);
  float choice[kBatch], unused[kBatch];
  if (measures) sampler.points(dimension::kPart, first, count, choice, unused);
  for (int i = 0; i < count; ++i) {
    samples[i] = {};
    if (measures) {
      const WeightedRay leaving = leave(*scene_.measured, {fu[i], fv[i]}, choice[i], {lu[i], lv[i]});
      rays[i] = leaving.ray;
      samples[i].weight = leaving.weight;
      continue;
    }
    const PixelFilter::Sample at = filter_.sample({fu[i], fv[i]});
    rays[i] = ray(x, y, at, has_lens ? Vec2(lu[i], lv[i]) : Vec2(0.5f));
    samples[i].weight = at.weight;
  }
}

Ray CameraRays::ray(int x, int y, const PixelFilter::Sample& at, const Vec2& lens) const {
  const Vec2 film((static_cast<float>(x) + 0.5f + at.offset.x) / static_cast<float>(width_),
                  (static_cast<float>(y) + 0.5f + at.offset.y) / static_cast<float>(height_));
  return generate_ray(camera_, film, lens);
}

void CameraRays::describe(const Ray& ray, const SurfaceHit& surface, PixelSample& sample) const {
  sample.depth = dot(camera_.to_world.origin - surface.position, camera_.to_world.z);
  sample.normal = dot(surface.shading_normal, ray.direction) > 0 ? -surface.shading_normal : surface.shading_normal;
}

}  // namespace etendue
