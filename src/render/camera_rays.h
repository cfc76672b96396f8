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
  /// What the film remembers of the first surface.
  void describe(const Ray& ray, const SurfaceHit& surface, PixelSample& sample) const;

 private:
  const RenderScene::Data& scene_;
  Camera camera_;
  PixelFilter filter_;
  int width_, height_;
};

}  // namespace etendue
