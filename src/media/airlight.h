#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "media/medium.h"

/// Light of a point-like source that a ray through a homogeneous medium gathers on its way, scattered once towards the
/// ray's origin (Nishita, Miyawaki and Nakamae 1987):
///
///   ∫ T(t) σs phase(t) I(t) T'(t) / d(t)² dt,  d the distance to the light, T' the transmittance from there
namespace etendue {

/// The part of a ray within the cone of half angle acos(cos_angle) around `axis`; the whole ray if the cone is wider
/// than a half-space. Nothing where they do not meet.
std::optional<Ray> within_cone(const Ray& ray, const Point3& apex, const Vec3& axis, float cos_angle);

/// A ray as seen from a light, which is at `distance` from the point of its line nearest to it. Angles are those at the
/// light from that point, at offset distance · tan(angle) along the ray (Kulla and Fajardo 2012, "Importance Sampling
/// Techniques for Path Tracing in Participating Media", section 4.1).
struct SeenRay {
  SeenRay(const Ray& ray, const Point3& light);

  double nearest, distance;
  double begin_offset, end_offset;  ///< from the nearest point, in metres; the end may be infinite
  double begin, end;                ///< angles, radians

  /// From where the ray has this offset, in metres.
  double to_light(double offset) const { return std::sqrt(distance * distance + offset * offset); }
  /// Density per metre, where the ray has this offset, of places at uniform angles (eq. 3).
  double uniform_angle_pdf(double offset) const;
  /// ∫ dt / d².
  double inverse_squares() const { return (end - begin) / distance; }
};

/// Samples the distance at which such light is scattered.
///
/// In the angle the integrand has lost 1/d² (eq. 4: dt = d²/distance dθ); the density of angles is piecewise linear and
/// in proportion to what is left of it where the pieces meet. Those places are angles at equal steps and optical depths
/// that double, so that both the light's surroundings and a dense medium's skin are resolved. What is between the light
/// and the ray is not known here: a share of the light is taken to come undimmed.
class AirlightDistances {
 public:
  /// Along `ray` from its t_min to its t_max; `throughput` is that of the path at t_min.
  AirlightDistances(const Medium& medium, const Ray& ray, const SeenRay& seen, const Spectrum& throughput);

  struct Sample {
    float t;
    float pdf;  ///< per metre
  };
  /// From u, uniform in [0, 1). Nothing where no light gets through.
  std::optional<Sample> sample(float u) const;

 private:
  static constexpr int kSteps = 8;   ///< of equal angles
  static constexpr int kDepths = 8;  ///< of doubled optical depths
  static constexpr float kFirstDepth = 0.25f;
  static constexpr float kUndimmed = 0.05f;

  struct Knot {
    double offset, angle;
    float value = 0;  ///< of the density, not normalized
  };
  void add_equal_angles();
  void add_depths(float max_extinction);

  SeenRay seen_;
  std::array<Knot, kSteps + 1 + kDepths> knots_;
  int count_ = 0;
  double total_ = 0;
};

}  // namespace etendue
