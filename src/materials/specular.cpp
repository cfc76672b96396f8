#include "materials/bsdf.h"
#include "materials/directions.h"
#include "materials/fresnel.h"

namespace etendue {
namespace {

/// Share of the light that `boundary` reflects; arguments as those of fresnel_dielectric.
float reflected_share(Boundary boundary, float cosine, float eta) {
  switch (boundary) {
    case Boundary::transmit_only:
      return 0;
    case Boundary::schlick:
      return fresnel_schlick(cosine, eta);
    case Boundary::fresnel:
      return fresnel_dielectric(cosine, eta);
    case Boundary::thin:
      break;
  }
  // R + T R T + T R³ T + … with T = 1 − R.
  const float once = fresnel_dielectric(cosine, eta);
  return 2 * once / (1 + once);
}

}  // namespace

Spectrum MirrorBsdf::share(float cosine) const {
  return eta.is_black() && k.is_black() ? reflectance : reflectance * fresnel_conductor(cosine, eta, k);
}

std::optional<BsdfSample> MirrorBsdf::sample(const Vec3& wo, Vec2, float, TransportMode) const {
  if (wo.z == 0) return std::nullopt;
  return BsdfSample{reflected(wo), share(std::abs(wo.z)), 0, Lobe::delta_reflection};
}

Spectrum MirrorBsdf::albedo() const {
  return share(1);
}

float DielectricBsdf::eta_from(const Vec3& wo) const {
  // Beyond a thin one's first boundary it is the inside from both sides.
  return wo.z > 0 || boundary == Boundary::thin ? ior : 1 / ior;
}

float DielectricBsdf::reflection_probability(const Vec3& wo) const {
  const float share = reflected_share(boundary, std::abs(wo.z), eta_from(wo));
  const float reflect = share * reflectance.max(), transmit = (1 - share) * transmittance.max();
  return reflect + transmit > 0 ? reflect / (reflect + transmit) : 0.0f;
}

std::optional<BsdfSample> DielectricBsdf::sample(const Vec3& wo, Vec2, float choice, TransportMode mode) const {
  if (wo.z == 0) return std::nullopt;
  const bool thin = boundary == Boundary::thin;
  const float eta = eta_from(wo);
  const float share = reflected_share(boundary, std::abs(wo.z), eta);
  const float probability = reflection_probability(wo);
  if (choice < probability)
    return BsdfSample{reflected(wo), reflectance * (share / probability), 0, Lobe::delta_reflection};
  const Spectrum transmitted = transmittance * ((1 - share) / (1 - probability));
  if (thin) return BsdfSample{-wo, transmitted, 0, Lobe::straight};
  const std::optional<Vec3> wi = refracted(wo, eta);
  if (!wi) return std::nullopt;
  return BsdfSample{*wi, transmitted * radiance_scale(eta, mode), 0, Lobe::delta_transmission, eta};
}

Spectrum DielectricBsdf::straight_through(const Vec3& wo) const {
  if (boundary != Boundary::thin) return Spectrum(0);
  return transmittance * (1 - reflected_share(boundary, std::abs(wo.z), ior));
}

}  // namespace etendue
