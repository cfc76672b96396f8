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

constexpr int kLanes = 4;  ///< three channels, and one more so that registers are full

}  // namespace

/// With a² + b² the modulus of √((η+ik)² − sin²θ) (Born and Wolf 1999, section 14.2).
Spectrum fresnel_conductor(float cos_i, const Spectrum& eta, const Spectrum& k) {
  const float etas[kLanes] = {eta.r, eta.g, eta.b, 1}, ks[kLanes] = {k.r, k.g, k.b, 1};
  const float cos2 = square(cos_i), sin2 = 1 - cos2;
  float reflected[kLanes];
  for (int c = 0; c < kLanes; ++c) {
    const float t0 = square(etas[c]) - square(ks[c]) - sin2;
    const float a2_plus_b2 = std::sqrt(square(t0) + 4 * square(etas[c] * ks[c]));
    const float a = safe_sqrt(0.5f * (a2_plus_b2 + t0));
    const float t1 = a2_plus_b2 + cos2, t2 = 2 * cos_i * a;
    const float t3 = cos2 * a2_plus_b2 + square(sin2), t4 = t2 * sin2;
    reflected[c] = 0.5f * contrast(t1, t2) * (1 + contrast(t3, t4));
  }
  return {reflected[0], reflected[1], reflected[2]};
}

}  // namespace etendue
