#include "materials/microfacet.h"

namespace etendue {
namespace {

/// Inverse error function to float precision (Giles 2010, "Approximating the erfinv Function", single-precision
/// version).
float erf_inverse(float x) {
  const float clamped = std::clamp(x, -0.99999994f, 0.99999994f);
  float w = -std::log((1 - clamped) * (1 + clamped));
  float p;
  if (w < 5) {
    w -= 2.5f;
    p = 2.81022636e-08f;
    for (const float c : {3.43273939e-07f, -3.5233877e-06f, -4.39150654e-06f, 0.00021858087f, -0.00125372503f,
                          -0.00417768164f, 0.246640727f, 1.50140941f})
      p = c + p * w;
  } else {
    w = std::sqrt(w) - 3;
    p = -0.000200214257f;
    for (const float c : {0.000100950558f, 0.00134934322f, -0.00367342844f, 0.00573950773f, -0.0076224613f,
                          0.00943887047f, 1.00167406f, 2.83297682f})
      p = c + p * w;
  }
  return p * clamped;
}

constexpr float kInvSqrtPi = 0.5641895835f;

/// erf(x) within 1.5·10⁻⁷, given exp(−x²) (Abramowitz and Stegun 1964, 7.1.26).
float erf_from_gaussian(float x, float gaussian) {
  const float t = 1 / (1 + 0.3275911f * std::abs(x));
  const float p =
      t * (0.254829592f + t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
  return std::copysign(1 - p * gaussian, x);
}

/// Λ of a Beckmann surface of width 1 from a direction with this cotangent (Walter et al. 2007, below eq. 23).
float beckmann_lambda(float cot) {
  if (cot > 4) return 0;
  const float gaussian = std::exp(-square(cot));
  return 0.5f * kInvSqrtPi * gaussian / cot - 0.5f * (1 - erf_from_gaussian(cot, gaussian));
}

/// Slope along the view direction of a Beckmann surface of width 1, seen from an angle with cotangent `cot`, given u.
/// The distribution function of the visible slope x on (−∞, cot) is C(x) / C(cot) with
///   C(x) = (1 + erf x)/2 + tan θ exp(−x²) / (2√π),  C(cot) = 1 + Λ      (Heitz and d'Eon 2014, supplemental).
/// With e = erf x and exp(−x²) ≈ 1 − e² it is a quadratic in e, whose root starts Halley's method; two steps do nearly
/// always.
float sample_visible_slope(float cot, float u) {
  const float tan = 1 / cot, t = 0.5f * kInvSqrtPi * tan;
  const float total = 1 + beckmann_lambda(cot), target = u * total;
  const float c = 0.5f + t - target;
  float low = -4, high = std::min(cot, 4.0f);  // beyond lies less than 10⁻⁷ of the probability
  float x = std::clamp(erf_inverse(-2 * c / (0.5f + safe_sqrt(0.25f + 4 * t * c))), low, 0.97f * high);
  for (int i = 0; i < 20; ++i) {
    const float gaussian = std::exp(-square(x));
    const float error = 0.5f * (1 + erf_from_gaussian(x, gaussian)) + t * gaussian - target;
    (error > 0 ? high : low) = x;
    // C′ = (1 − x tan θ) exp(−x²) / √π, and C″ / C′ = −2x − tan θ / (1 − x tan θ).
    const float facing = 1 - x * tan;
    const float newton = error / (facing * gaussian * kInvSqrtPi);
    const float bend = newton * (-2 * x - tan / facing);
    const float next = x - newton / (1 - 0.5f * bend);
    const bool inside = next >= low && next <= high;
    x = inside ? next : 0.5f * (low + high);
    if (inside && std::abs(error) * square(bend) < 1e-6f * total) break;  // what a step leaves is of the third order
  }
  return x;
}

Vec3 sample_beckmann(const Vec3& w, float alpha, Vec2 u) {
  const Vec3 stretched = normalize(Vec3(alpha * w.x, alpha * w.y, w.z));
  const float sin = std::sqrt(square(stretched.x) + square(stretched.y));
  const float cos_phi = sin > 1e-7f ? stretched.x / sin : 1.0f, sin_phi = sin > 1e-7f ? stretched.y / sin : 0.0f;
  constexpr float kSafe = 1e-6f;
  // At normal incidence all slopes are seen alike: the marginal is the Gaussian's.
  const float ux = std::clamp(u.x, kSafe, 1 - kSafe), uy = std::clamp(u.y, kSafe, 1 - kSafe);
  const float along = sin < 1e-4f ? erf_inverse(2 * ux - 1) : sample_visible_slope(stretched.z / sin, ux);
  const float across = erf_inverse(2 * uy - 1);
  const float x = alpha * (cos_phi * along - sin_phi * across), y = alpha * (sin_phi * along + cos_phi * across);
  return normalize(Vec3(-x, -y, 1));
}

Vec3 sample_ggx(const Vec3& w, float alpha, Vec2 u) {
  const Vec3 standard = normalize(Vec3(alpha * w.x, alpha * w.y, w.z));
  const float phi = 2 * kPi * u.x;
  const float z = (1 - u.y) * (1 + standard.z) - standard.z;
  const float r = safe_sqrt(1 - z * z);
  const Vec3 half = Vec3(r * std::cos(phi), r * std::sin(phi), z) + standard;
  return normalize(Vec3(alpha * half.x, alpha * half.y, std::max(half.z, 1e-7f)));
}

}  // namespace

float MicrofacetDistribution::density(const Vec3& m) const {
  if (m.z <= 0) return 0;
  const float cos2 = square(m.z), sin2 = square(m.x) + square(m.y), alpha2 = square(alpha_);
  if (kind_ == MicrofacetKind::ggx) return alpha2 / (kPi * square(alpha2 * cos2 + sin2));
  const float steepness = sin2 / (cos2 * alpha2);
  return steepness < 80 ? std::exp(-steepness) / (kPi * alpha2 * square(cos2))
                        : 0.0f;  // at the horizon cos⁴ vanishes, too
}

float MicrofacetDistribution::lambda(const Vec3& w) const {
  const float sin = std::sqrt(square(w.x) + square(w.y));
  if (sin == 0) return 0;
  const float a = std::abs(w.z) / (alpha_ * sin);
  if (kind_ == MicrofacetKind::ggx) return 0.5f * (std::sqrt(1 + 1 / square(a)) - 1);
  return beckmann_lambda(a);
}

float MicrofacetDistribution::visibility(const Vec3& w) const {
  return 1 / (1 + lambda(w));
}

float MicrofacetDistribution::visible_pdf(const Vec3& w, const Vec3& m) const {
  return visibility(w) * std::max(0.0f, dot(w, m)) * density(m) / w.z;
}

Vec3 MicrofacetDistribution::sample_visible(const Vec3& w, Vec2 u) const {
  return kind_ == MicrofacetKind::beckmann ? sample_beckmann(w, alpha_, u) : sample_ggx(w, alpha_, u);
}

}  // namespace etendue
