#pragma once

#include <memory>
#include <span>

#include "camera/camera.h"
#include "render/film.h"
#include "render/scene_data.h"
#include "render/settings.h"

namespace etendue {

/// Estimates the radiance that arrives at a pixel. Immutable: all threads share one.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Fills samples[i] with sample first + i of pixel (x, y); at most Geometry::kBatch at a time. Returns the number of rays traced.
  /// The result depends on nothing but its arguments.
  virtual std::uint64_t estimate(int x, int y, std::uint32_t first, std::span<PixelSample> samples) const = 0;
};

/// The integrator that `settings` ask for. The scene must outlive it.
std::unique_ptr<Integrator> make_integrator(const RenderScene::Data& scene, const Camera& camera,
                                            const RenderSettings& settings);

/// Camera rays of samples first, first + 1, … of a pixel.
class CameraRays {
 public:
  CameraRays(const Camera& camera, const RenderSettings& settings)
      : camera_(camera), width_(settings.width), height_(settings.height) {}
  void generate(const PixelSampler& sampler, int x, int y, std::uint32_t first, std::span<Ray> rays) const;
  /// What the film remembers of the first surface.
  void describe(const Ray& ray, const RayHit& hit, const SurfaceHit& surface, PixelSample& sample) const;

 private:
  Camera camera_;
  int width_, height_;
};

/// The random numbers' dimensions: two for the camera, then a block for each bounce.
namespace dimension {
inline constexpr std::uint64_t kFilm = 0, kLens = 1;
inline constexpr std::uint64_t kBounceStride = std::uint64_t{1} << 33;  // room for two of each of 2³² lights
inline constexpr std::uint64_t kDirection = 2, kLobeAndRoulette = 3, kLightChoice = 4, kLights = 5;
inline constexpr std::uint64_t at(int bounce, std::uint64_t slot) {
  return static_cast<std::uint64_t>(bounce) * kBounceStride + slot;
}
/// Where a point on a light lies, and on which part of the light.
inline constexpr std::uint64_t position(std::uint64_t light) { return kLights + 2 * light; }
inline constexpr std::uint64_t part(std::uint64_t light) { return kLights + 2 * light + 1; }
static_assert(at(0, part(0xffff'fff0u)) < at(1, kDirection), "the lights of one bounce reach into the next");
}  // namespace dimension

}  // namespace etendue
