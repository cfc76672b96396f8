#pragma once

#include <optional>
#include <vector>

#include "geometry/geometry.h"
#include "lights/light.h"

/// Light leaving lights: how paths begin that start there.
namespace etendue {

/// A point of a light's surface.
struct LightPoint {
  SurfaceHit surface;  ///< its front is the side that shines
  Spectrum radiance;   ///< the same into all directions of the front
  float pdf_area = 0;
};

/// A point of a light that has a surface: by area, or by flux where that differs over a mesh. Nothing for all others.
std::optional<LightPoint> sample_light_point(const Light& light, Vec2 u, float choice);
/// Density by area with which sample_light_point gives `hit`.
float light_point_pdf(const Light& light, const LightHit& hit);

/// A ray of light.
struct EmittedRay {
  Ray ray;
  Spectrum radiance;
  /// With which it was chosen, per m² across the ray and sr: the measure of étendue.
  float density = 0;
  std::uint32_t light = 0;  ///< whose it is
};

/// A ball at which light is aimed.
struct AimTarget {
  Point3 center;
  float radius = 0;
};

/// Sends light into a few balls that hold all that is worth hitting: photons that miss them are never made (the
/// projection maps of Jensen 1996, section 4, without a map).
class LightAim {
 public:
  static constexpr std::size_t kMostTargets = 16;

  LightAim() = default;
  /// At most kMostTargets: each emitted ray looks at all of them. `lights` have to outlive it. Lights that BSDF
  /// sampling cannot find (points, spots, parallel light) send nothing.
  LightAim(const std::vector<Light>& lights, std::vector<AimTarget> targets, const Bounds3& scene);

  /// Whether any light can send anything.
  bool possible() const { return can_send_; }

  /// Random numbers are uniform: `which` light and part, `position`, `direction`, and `target`.
  std::optional<EmittedRay> sample(Vec2 which, Vec2 position, Vec2 direction, float target) const;
  /// A direction from a point of a surface towards the targets, within the hemisphere around its normal. Nothing if
  /// none of them can be seen from there.
  struct Direction {
    Vec3 w;         ///< unit
    float pdf = 0;  ///< per solid angle
  };
  std::optional<Direction> direction(const Point3& from, const Vec3& normal, Vec2 u, float target) const;
  /// With which direction() gives `w`, unit.
  float direction_pdf(const Point3& from, const Vec3& normal, const Vec3& w) const;

  /// Density with which sample() gives the ray that leaves `hit` of a finite light along `w`, unit.
  float density(std::uint32_t light, const LightHit& hit, const Vec3& w) const;
  /// The same for light from infinity that arrives at `position` from the direction `wi`, which sample_light gives with
  /// density `pdf`.
  float density_from_infinity(std::uint32_t light, const Point3& position, const Vec3& wi, float pdf) const;

 private:
  struct Cone;
  Cone cone(const AimTarget& target, const Point3& from, const Vec3& normal) const;
  std::optional<EmittedRay> leave(const Light& light, float part, Vec2 position, Vec2 direction, float target) const;
  std::optional<EmittedRay> arrive(const Light& light, Vec2 position, Vec2 direction, float target) const;
  float disk_pdf(const Point3& position, const Vec3& w) const;

  const std::vector<Light>* lights_ = nullptr;
  std::vector<AimTarget> targets_;
  bool can_send_ = false;
  DiscreteDistribution choice_;   ///< among all lights
  DiscreteDistribution by_disk_;  ///< targets by their cross-section
  Bounds3 scene_;
};

}  // namespace etendue
