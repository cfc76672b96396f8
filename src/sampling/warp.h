#pragma once

#include "math/vec.h"

/// Maps from the unit square to distributions. Each `sample_…` has a `…_pdf` in the measure its comment names.
namespace etendue {

/// Uniform by area on the unit disk, keeping areas and neighbourhoods (Shirley and Chiu 1997). Density 1/π.
Vec2 sample_disk_concentric(Vec2 u);
inline constexpr float disk_pdf() {
  return kInvPi;
}

/// Cosine-weighted about +z, solid angle density cos θ / π (Malley's method).
Vec3 sample_hemisphere_cosine(Vec2 u);
inline float hemisphere_cosine_pdf(const Vec3& w) {
  return w.z > 0 ? w.z * kInvPi : 0.0f;
}

/// Uniform on the hemisphere about +z, density 1 / 2π.
Vec3 sample_hemisphere_uniform(Vec2 u);
inline float hemisphere_uniform_pdf(const Vec3& w) {
  return w.z >= 0 ? 0.5f * kInvPi : 0.0f;
}

/// Uniform on the sphere, density 1 / 4π.
Vec3 sample_sphere_uniform(Vec2 u);
inline constexpr float sphere_uniform_pdf() {
  return 0.25f * kInvPi;
}

/// Uniform in the cone about +z with 1 − cos θ_max = `one_minus_cos`; density 1 / (2π · one_minus_cos). Precise for the
/// smallest cones.
Vec3 sample_cone_uniform(Vec2 u, float one_minus_cos);
inline float cone_uniform_pdf(float one_minus_cos) {
  return 1.0f / (2.0f * kPi * one_minus_cos);
}

/// Uniform by area on a triangle: barycentric weights of its second and third vertex (Heitz 2019, "A Low-Distortion Map
/// Between Triangle and Square"). Density 1 / area.
Vec2 sample_triangle_uniform(Vec2 u);

}  // namespace etendue
