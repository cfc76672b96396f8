#pragma once

#include "render/cache_filler.h"
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
///
/// Light of lamps, which are points, does not wait for a path to be scattered in their light: every early segment of a
/// path through a homogeneous medium samples the distance at which it is (AirlightDistances), with density p:
///
///   radiance += throughput · T(t) σt albedo phase · I T' / d² / p(t),  throughput that before the flight
///
/// Its integrand p resembles but for what casts shadows; the path goes on from where its flight ends, and asks the
/// other lights there.
///
/// Where a segment begins, a second technique finds light that was scattered in the medium before it comes there: it
/// chooses a ray out of the lamp, uniformly in its cone, and a point y on it by the angle at the path's vertex x, which
/// takes out the other 1/d² (compare Georgiev et al. 2013, "Joint Importance Sampling of Low-Order Volumetric
/// Scattering", section 4). In the measure of directions at x and distances d = |xy|, with s = |y lamp|, the balance is
/// between
///
///   p_beam = chance · p(direction | cone) · p_angle(s | x) · d² / s²  and  p_way = pdf_scatter · p_angle(d | lamp),
///
/// p_angle the equi-angular densities. The latter stands for the density p above, which nobody knows at y; the weights
/// sum to one all the same, as functions of x, y and the lamp.
///
/// What goes on from the first place of scattering in a medium that the camera sees, and from later ones that the path
/// reaches by directions that are spread widely enough, is looked up (radiance_cache.h) instead of followed; on the
/// camera's segments at several places.
class VolumePathIntegrator : public Integrator {
 public:
  VolumePathIntegrator(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings);
  std::string_view promise() const override;
  std::uint32_t generation_size() const override;
  std::uint64_t prepare(std::uint32_t generation) override;
  std::uint64_t estimate(const PixelBlock& block, std::uint32_t first, int count,
                         std::span<PixelSample> samples) const override;

 private:
  class Walk;

  /// A light that is a point, shines into a cone, and is about so bright (LightBounds).
  struct Lamp {
    std::uint32_t light;
    Point3 position;
    Vec3 axis;
    float cos_angle, one_minus_cos, intensity;
    float chance = 1;  ///< of asking for its beam
  };
  /// Where there are more, the light tree does better, at places of scattering.
  static constexpr int kMostLamps = 16;
  static std::vector<Lamp> find_lamps(const RenderScene::Data& scene);

  const RenderScene::Data& scene_;
  RenderSettings settings_;
  CameraRays camera_rays_;
  Bounds3 bounds_;           ///< of the scene
  bool tracks_;              ///< some medium is heterogeneous
  std::vector<Lamp> lamps_;  ///< none: segments gather no light
  int airlight_bounces_;     ///< paths that were scattered as often gather none any more
  std::optional<CacheFiller> cache_filler_;
  std::optional<RadianceCache> cache_;
};

}  // namespace etendue
