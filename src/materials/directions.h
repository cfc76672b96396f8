#pragma once

#include <optional>

#include "materials/bsdf_model.h"

/// Where light goes at a surface: directions as in BsdfModel.
namespace etendue {

/// `w` seen on a surface that is turned over by mirroring at its plane.
inline Vec3 mirrored(const Vec3& w) {
  return {w.x, w.y, -w.z};
}

inline Vec3 reflected(const Vec3& wo) {
  return {-wo.x, -wo.y, wo.z};
}
/// Reflected by a facet with the normal `m`.
inline Vec3 reflected(const Vec3& wo, const Vec3& m) {
  return normalize(m * (2 * dot(wo, m)) - wo);
}

/// Snell's law: wo through the boundary, `eta` = index beyond it / index on wo's side. Nothing under total internal
/// reflection.
inline std::optional<Vec3> refracted(const Vec3& wo, float eta) {
  const float sin2_t = (1 - square(wo.z)) / square(eta);
  if (sin2_t >= 1) return std::nullopt;
  const float cos_t = safe_sqrt(1 - sin2_t);
  return Vec3(-wo.x / eta, -wo.y / eta, wo.z > 0 ? -cos_t : cos_t);
}
/// The same at a facet whose normal `m` is on wo's side.
inline std::optional<Vec3> refracted(const Vec3& wo, const Vec3& m, float eta) {
  const float cos_o = dot(wo, m), sin2_t = (1 - square(cos_o)) / square(eta);
  if (sin2_t >= 1) return std::nullopt;
  return normalize(m * (cos_o / eta - safe_sqrt(1 - sin2_t)) - wo / eta);
}

/// Normal of the facet that sends light from wi to wo: by reflection, or refraction with `eta` as above. wo is above
/// the surface, and so is what comes back. Nothing where rounding leaves none.
inline std::optional<Vec3> half_vector(const Vec3& wo, const Vec3& wi, float eta) {
  const Vec3 sum = wi.z > 0 ? wo + wi : wo + wi * eta;
  const float length2 = length_squared(sum);
  if (!(length2 > 0) || sum.z == 0) return std::nullopt;
  return sum * (std::copysign(1.0f, sum.z) / std::sqrt(length2));
}

/// Radiance is proportional to the squared index, so what arrives here from beyond the boundary is divided by eta².
inline float radiance_scale(float eta, TransportMode mode) {
  return mode == TransportMode::radiance ? 1 / square(eta) : 1.0f;
}

}  // namespace etendue
