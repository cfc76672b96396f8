#pragma once

#include "render/cache_filler.h"
#include "render/integrator.h"
#include "render/path_batch.h"

namespace etendue {

/// Unidirectional path tracing (Kajiya 1986) with next-event estimation and multiple importance sampling of lights and
/// BSDF by the power heuristic (Veach 1997, chapter 9), a batch of paths at a time (path_batch.h):
///
///   radiance += throughput · Σ_lights  f cos · L / pdf_light · w(pdf_light, pdf_bsdf)      [visible]
///   throughput ·= f cos / pdf_bsdf;  at the next surface  radiance += throughput · Le · w(pdf_bsdf, pdf_light)
///
/// Light that comes by way of mirrors and smooth glass alone is found by photons as well (CausticPhotons).
///
/// Long ways through mirrors and glass are followed more often than paths go them (CameraChains).
///
/// Neighbouring pixels share what their paths find beyond the first vertex (path_reuse.h), and light that comes to
/// their paths' later vertices from diffuse surfaces is looked up (radiance_cache.h).
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
  std::uint64_t share(std::span<const SharedPath> paths, int pixels, int count, std::span<PixelSample> samples) const;
  std::uint64_t fill_cache(std::uint32_t generation);
  const RenderScene::Data& scene() const { return common_.scene; }

  PathCommons common_;
  std::optional<CacheFiller> cache_filler_;
  bool reuse_;  ///< neighbouring pixels share their paths
  std::uint32_t generation_size_;
};

}  // namespace etendue
