#pragma once

#include <span>

#include "camera/camera.h"
#include "camera/filter.h"
#include "render/film.h"
#include "render/scene_data.h"
#include "render/settings.h"
#include "sampling/sampler.h"

namespace etendue {

/// Where paths begin.
class CameraRays {
 public:
  /// The scene has to outlive it.
  CameraRays(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings);

  /// Rays of samples first, first + 1, … of pixel (x, y); the samples are cleared and given their weights.
  void generate(const PixelSampler& sampler, int x, int y, std::uint32_t first, std::span<Ray> rays,
                std::span<PixelSample> samples) const;
  /// The ray of a sample of a thin lens camera's pixel with these random numbers. A pinhole uses the first alone.
  Ray ray(int x, int y, const Vec2& film, const Vec2& lens) const { return ray(x, y, filter_.sample(film), lens); }
  /// Whether all samples of a pixel have the same weight.
  bool all_weigh_alike() const { return !filter_.has_negative_lobes() && !scene_.measured; }
  /// What the film remembers of the first surface.
  void describe(const Ray& ray, const SurfaceHit& surface, PixelSample& sample) const;

 private:
  Ray ray(int x, int y, const PixelFilter::Sample& at, const Vec2& lens) const;
  const RenderScene::Data& scene_;
  Camera camera_;
  PixelFilter filter_;
  int width_, height_;
};

}  // namespace etendue
