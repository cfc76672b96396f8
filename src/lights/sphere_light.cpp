#include "geometry/geometry.h"
#include "lights/light.h"
#include "math/frame.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

/// 1 − cos of the half angle under which a sphere is seen from squared distance d2 > r2 of its centre, without
/// cancellation.
float subtended_one_minus_cos(float r2, float d2) {
  const float sin2 = r2 / d2;
  return sin2 / (1 + safe_sqrt(1 - sin2));
}

}  // namespace

std::optional<LightSample> SphereLight::sample(const Point3& from, Vec2 u) const {
  const Vec3 to_center = center - from;
  const float d2 = length_squared(to_center), r2 = square(radius);
  if (d2 <= r2) return std::nullopt;
  const float one_minus_cos = subtended_one_minus_cos(r2, d2);
  const float d = std::sqrt(d2);
  const Vec3 local = sample_cone_uniform(u, one_minus_cos);
  // Nearer intersection of the chosen direction, d cos θ − √(r² − d² sin² θ), without that difference: it cancels near
  // the sphere.
  const float sin2 = square(local.x) + square(local.y);
  const float distance = (d - radius) * (d + radius) / (d * local.z + safe_sqrt(r2 - d2 * sin2));
  const Vec3 wi = Frame::from_normal(to_center * (1 / d)).to_world(local);
  const Vec3 normal = normalize(wi * distance - to_center);
  return LightSample{wi,
                     distance,
                     emitted,
                     cone_uniform_pdf(one_minus_cos),
                     false,
                     normal,
                     kRelativeError * (max_abs_component(center) + radius)};
}

float SphereLight::pdf_hit(const Point3& from, const LightHit&) const {
  const float d2 = length_squared(center - from), r2 = square(radius);
  return d2 <= r2 ? 0.0f : cone_uniform_pdf(subtended_one_minus_cos(r2, d2));
}

float SphereLight::power(const Bounds3&) const {
  return kPi * 4 * kPi * square(radius) * emitted.luminance();
}

LightBounds SphereLight::bounds() const {
  return {{center - Vec3(radius), center + Vec3(radius)},
          DirectionCone::all(),
          0,
          kPi * square(radius) * emitted.luminance()};
}

}  // namespace etendue
