#pragma once

#include "render/direct_light.h"
#include "render/integrator.h"

namespace etendue {

/// Unidirectional path tracing (Kajiya 1986) with next-event estimation and multiple importance sampling of lights and
/// BSDF by the power heuristic (Veach 1997, chapter 9). Carries up to Geometry::kBatch paths of one pixel from bounce
/// to bounce together, so that camera rays and shadow rays of the same bounce travel as packets and random numbers are
/// made in one go:
///
///   radiance += throughput · Σ_lights  f cos · L / pdf_light · w(pdf_light, pdf_bsdf)      [visible]
///   throughput ·= f cos / pdf_bsdf;  at the next surface  radiance += throughput · Le · w(pdf_bsdf, pdf_light)
///
/// With IntegratorKind::hemisphere direct light is found by uniform directions instead, without multiple importance
/// sampling.
class PathIntegrator : public Integrator {
 public:
  PathIntegrator(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings);
  std::uint64_t estimate(int x, int y, std::uint32_t first, std::span<PixelSample> samples) const override;

 private:
  struct Path;
  class Batch;

  float light_density(const Receiver& at, std::uint32_t light, std::uint32_t part) const;

  const RenderScene::Data& scene_;
  RenderSettings settings_;
  CameraRays camera_rays_;
  bool every_light_;  ///< each vertex asks every light; else it asks one
  bool hemisphere_;   ///< direct light by uniform directions
};

}  // namespace etendue
