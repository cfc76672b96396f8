#include "materials/bsdf.h"
#include "materials/fresnel.h"

namespace etendue {
namespace {

Vec3 reflected(const Vec3& wo) { return {-wo.x, -wo.y, wo.z}; }

/// Snell's law: wo through the boundary, `eta` = index beyond it / index on wo's side. Nothing under total internal reflection.
std::optional<Vec3> refracted(const Vec3& wo, float eta) {
  const float sin2_t = (1 - square(wo.z)) / square(eta);
  if (sin2_t >= 1) return std::nullopt;
  const float cos_t = safe_sqrt(1 - sin2_t);
  return Vec3(-wo.x / eta, -wo.y / eta, wo.z > 0 ? -cos_t : cos_t);
}

/// Radiance is proportional to the squared index, so what arrives here from beyond the boundary is divided by eta².
float radiance_scale(float eta, TransportMode mode) { return mode == TransportMode::radiance ? 1 / square(eta) : 1.0f; }

}  // namespace

std::optional<BsdfSample> MirrorBsdf::sample(const Vec3& wo, Vec2, float, TransportMode) const {
  if (wo.z == 0) return std::nullopt;
  return BsdfSample{reflected(wo), reflectance, 0, Lobe::delta_reflection};
}

std::optional<BsdfSample> DielectricBsdf::sample(const Vec3& wo, Vec2, float choice, TransportMode mode) const {
  if (wo.z == 0) return std::nullopt;
  const float eta = wo.z > 0 ? ior : 1 / ior;
  const float cosine = std::abs(wo.z);
  const float fresnel = schlick ? fresnel_schlick(cosine, eta) : fresnel_dielectric(cosine, eta);
  const float reflect = fresnel * reflectance.max(), transmit = (1 - fresnel) * transmittance.max();
  if (reflect + transmit <= 0) return std::nullopt;
  const float probability = reflect / (reflect + transmit);
  if (choice < probability)
    return BsdfSample{reflected(wo), reflectance * (fresnel / probability), 0, Lobe::delta_reflection};
  const std::optional<Vec3> wi = refracted(wo, eta);
  if (!wi) return std::nullopt;
  const float factor = (1 - fresnel) / (1 - probability) * radiance_scale(eta, mode);
  return BsdfSample{*wi, transmittance * factor, 0, Lobe::delta_transmission, eta};
}

std::optional<BsdfSample> RefractionBsdf::sample(const Vec3& wo, Vec2, float, TransportMode mode) const {
  if (wo.z == 0) return std::nullopt;
  const float eta = wo.z > 0 ? ior : 1 / ior;
  const std::optional<Vec3> wi = refracted(wo, eta);
  if (!wi) return std::nullopt;
  return BsdfSample{*wi, transmittance * radiance_scale(eta, mode), 0, Lobe::delta_transmission, eta};
}

}  // namespace etendue
