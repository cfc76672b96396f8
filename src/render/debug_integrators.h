#pragma once

#include "render/integrator.h"

namespace etendue {

/// Pictures of one property of the first surface: shading normals, albedo, or ambient occlusion.
class DebugIntegrator : public Integrator {
 public:
  DebugIntegrator(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings)
      : scene_(scene), settings_(settings), camera_rays_(scene, camera, settings) {}
  std::uint64_t estimate(const PixelBlock& block, std::uint32_t first, int count,
                         std::span<PixelSample> samples) const override;

 private:
  const RenderScene::Data& scene_;
  RenderSettings settings_;
  CameraRays camera_rays_;
};

}  // namespace etendue
