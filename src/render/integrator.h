#pragma once

#include <memory>
#include <span>

#include "render/camera_rays.h"

namespace etendue {

/// Estimates the radiance that arrives at a pixel. Immutable: all threads share one.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Fills samples[i] with sample first + i of pixel (x, y); at most Geometry::kBatch at a time. Returns the number of
  /// rays traced. The result depends on nothing but its arguments.
  virtual std::uint64_t estimate(int x, int y, std::uint32_t first, std::span<PixelSample> samples) const = 0;
};

/// The integrator that `settings` ask for. The scene must outlive it.
std::unique_ptr<Integrator> make_integrator(const RenderScene::Data& scene, const Camera& camera,
                                            const RenderSettings& settings);

}  // namespace etendue
