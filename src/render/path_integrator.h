#pragma once

#include <optional>

#include "render/caustic_photons.h"
#include "render/direct_light.h"
#include "render/integrator.h"
#include "render/path_reuse.h"

namespace etendue {

/// Unidirectional path tracing (Kajiya 1986) with next-event estimation and multiple importance sampling of lights and
/// BSDF by the power heuristic (Veach 1997, chapter 9). Carries up to Geometry::kBatch paths of one pixel from bounce
/// to bounce together, so that camera rays and shadow rays of the same bounce travel as packets and random numbers are
/// made in one go:
///
///   radiance += throughput · Σ_lights  f cos · L / pdf_light · w(pdf_light, pdf_bsdf)      [visible]
///   throughput ·= f cos / pdf_bsdf;  at the next surface  radiance += throughput · Le · w(pdf_bsdf, pdf_light)
///
/// Light that comes by way of mirrors and smooth glass alone is found by photons as well (CausticPhotons).
///
/// Neighbouring pixels share what their paths find beyond the first vertex (path_reuse.h).
///
/// With IntegratorKind::hemisphere direct light is found by uniform directions instead, without multiple importance
/// sampling.
class PathIntegrator : public Integrator {
 public:
  PathIntegrator(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings);
  std::string_view promise() const override;
  std::uint32_t generation_size() const override;
  std::uint64_t prepare(std::uint32_t generation) override;
  int block_side() const override;
  std::uint64_t estimate(const PixelBlock& block, std::uint32_t first, int count,
                         std::span<PixelSample> samples) const override;

 private:
  struct Path;
  class Batch;

  std::uint64_t share(std::span<const SharedPath> paths, int pixels, int count, std::span<PixelSample> samples) const;
  float light_density(const Receiver& at, std::uint32_t light, std::uint32_t part) const;

  const RenderScene::Data& scene_;
  RenderSettings settings_;
  CameraRays camera_rays_;
  bool every_light_;  ///< each vertex asks every light; else it asks one
  bool hemisphere_;   ///< direct light by uniform directions
  bool splits_;       ///< early vertices ask several lights
  bool reuse_;        ///< neighbouring pixels share their paths
  std::uint32_t generation_size_ = 0;
  std::optional<CausticPhotons> photons_;
};

}  // namespace etendue
