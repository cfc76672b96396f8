#include "materials/principled_lobes.h"

#include <limits>

namespace etendue::principled {

float schlick_weight(float cosine) {
  const float m = std::clamp(1 - cosine, 0.0f, 1.0f);
  return square(square(m)) * m;
}

float unit(float x) {
  return std::clamp(x, 0.0f, 1.0f);
}

Spectrum not_negative(const Spectrum& colour) {
  return {std::max(colour.r, 0.0f), std::max(colour.g, 0.0f), std::max(colour.b, 0.0f)};
}

Spectrum tint(const Spectrum& colour) {
  const float luminance = colour.luminance();
  return luminance >= std::numeric_limits<float>::min() ? colour / luminance : Spectrum(1);
}

Spectrum sheen_colour(const Spectrum& base_color, float sheen_tint) {
  return Spectrum(1 - unit(sheen_tint)) + tint(base_color) * unit(sheen_tint);
}

MicrofacetDistribution microfacets(float roughness, float anisotropic) {
  constexpr float kMinAlpha = 1e-3f;
  const float alpha = square(roughness), aspect = std::sqrt(1 - 0.9f * anisotropic);
  return {MicrofacetKind::ggx, std::max(alpha / aspect, kMinAlpha), std::max(alpha * aspect, kMinAlpha)};
}

Spectrum BlendedFresnel::operator()(float cosine, float eta, float exact) const {
  // As in fresnel_schlick(), the cosine on the thinner side.
  const float thin_side = eta > 1 ? cosine : safe_sqrt(1 - (1 - square(cosine)) / square(eta));
  const float weight = schlick_weight(thin_side);
  return Spectrum(dielectric * exact + grazing * weight) + normal * (1 - weight);
}

Spectrum BurleyDiffuse::f_cos(const Vec3& wo, const Vec3& wi) const {
  const float at_o = schlick_weight(wo.z), at_i = schlick_weight(wi.z);
  const float cos2_d = std::clamp(0.5f * (1 + dot(wo, wi)), 0.0f, 1.0f);  // of half the angle between them
  const float retro = 2 * roughness * cos2_d;
  float shape = (1 - 0.5f * at_o) * (1 - 0.5f * at_i) + retro * (at_o + at_i + at_o * at_i * (retro - 1));
  shape *= wi.z;
  if (flatness > 0) {
    const float fss90 = roughness * cos2_d;
    const float fss = lerp(at_o, 1, fss90) * lerp(at_i, 1, fss90);
    const float subsurface = 1.25f * (fss * (wi.z / (wo.z + wi.z) - 0.5f * wi.z) + 0.5f * wi.z);
    shape = lerp(flatness, shape, subsurface);
  }
  return colour * (shape * kInvPi) + sheen * (schlick_weight(std::sqrt(cos2_d)) * wi.z);
}

}  // namespace etendue::principled
