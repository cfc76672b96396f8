#include "materials/fresnel.h"

#include "math/vec.h"

namespace etendue {

float fresnel_dielectric(float cos_i, float eta) {
  const float sin2_t = (1 - square(cos_i)) / square(eta);
  if (sin2_t >= 1) return 1;
  const float cos_t = safe_sqrt(1 - sin2_t);
  const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return 0.5f * (square(parallel) + square(perpendicular));
}

float fresnel_schlick(float cos_i, float eta) {
  float cosine = cos_i;
  if (eta < 1) {  // this side is the denser one: use the angle beyond the boundary
    const float sin2_t = (1 - square(cos_i)) / square(eta);
    if (sin2_t >= 1) return 1;
    cosine = safe_sqrt(1 - sin2_t);
  }
  const float r0 = square((1 - eta) / (1 + eta));
  const float m = 1 - cosine;
  return r0 + (1 - r0) * square(square(m)) * m;
}

namespace {

/// (a − b) / (a + b), for a ≥ b ≥ 0 but for rounding. All is reflected where both vanish: straight onto an index of 0,
/// along a boundary to an index of 1.
float contrast(float a, float b) {
  return a + b > 0 ? std::max(a - b, 0.0f) / (a + b) : 1.0f;
}

/// One channel, with a² + b² the modulus of √((η+ik)² − sin²θ) (Born and Wolf 1999, section 14.2).
float conductor_channel(float cos_i, float eta, float k) {
  const float cos2 = square(cos_i), sin2 = 1 - cos2;
  const float t0 = square(eta) - square(k) - sin2;
  const float a2_plus_b2 = std::sqrt(square(t0) + 4 * square(eta * k));
  const float a = safe_sqrt(0.5f * (a2_plus_b2 + t0));
  const float t1 = a2_plus_b2 + cos2, t2 = 2 * cos_i * a;
  const float perpendicular = contrast(t1, t2);
  const float t3 = cos2 * a2_plus_b2 + square(sin2), t4 = t2 * sin2;
  return 0.5f * perpendicular * (1 + contrast(t3, t4));
}

}  // namespace

Spectrum fresnel_conductor(float cos_i, const Spectrum& eta, const Spectrum& k) {
  return {conductor_channel(cos_i, eta.r, k.r), conductor_channel(cos_i, eta.g, k.g),
          conductor_channel(cos_i, eta.b, k.b)};
}

}  // namespace etendue
