#pragma once

#include "render/integrator.h"

namespace etendue {

/// Path tracing through participating media: as PathIntegrator, and paths are scattered in media on their way. Light
/// that a shadow ray brings is dimmed by what it passes. Multiple importance sampling knows the probability of getting
/// through, where that is known:
///
///   radiance += throughput · f cos · L · T / pdf_light · w(pdf_light, pdf_scatter · survival)
///   throughput ·= f cos / pdf_scatter · weight of the flight;  at light  radiance += throughput · Le · w(pdf_scatter ·
///   survival, pdf_light)
///
/// Both weights are functions of the path alone, so they sum to one (Miller, Georgiev and Jarosz 2019, section 5).
class VolumePathIntegrator : public Integrator {
 public:
  VolumePathIntegrator(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings);
  std::uint64_t estimate(int x, int y, std::uint32_t first, std::span<PixelSample> samples) const override;

 private:
  class Walk;

  const RenderScene::Data& scene_;
  RenderSettings settings_;
  CameraRays camera_rays_;
};

}  // namespace etendue
