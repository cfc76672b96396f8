#include <limits>

#include "lights/light.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Area of the disk that parallel light needs to cover the scene.
float scene_disk_area(const Bounds3& scene) {
  return kPi * square(0.5f * scene.diagonal());
}

/// The uv square maps to the sphere with Jacobian 2π² sin θ.
float uv_to_solid_angle(float pdf_uv, const Vec3& w) {
  const float sin_theta = std::sqrt(square(w.x) + square(w.z));
  return sin_theta > 0 ? pdf_uv / (2 * square(kPi) * sin_theta) : 0.0f;
}

}  // namespace

std::optional<LightSample> DirectionalLight::sample(const Point3&, Vec2, float) const {
  return LightSample{to_light, kInfinity, irradiance, 1, true};
}

float DirectionalLight::power(const Bounds3& scene) const {
  return irradiance.luminance() * scene_disk_area(scene);
}

std::optional<LightSample> UniformLight::sample(const Point3&, Vec2 u, float) const {
  if (!upper_half) return LightSample{sample_sphere_uniform(u), kInfinity, emitted, sphere_uniform_pdf()};
  const Vec3 w = sample_hemisphere_uniform(u);
  return LightSample{{w.x, w.z, w.y}, kInfinity, emitted, hemisphere_uniform_pdf(w)};
}

InfiniteView UniformLight::look(const Vec3& wi) const {
  if (!upper_half) return {emitted, sphere_uniform_pdf()};
  if (wi.y < 0) return {};
  return {emitted, hemisphere_uniform_pdf({wi.x, wi.z, wi.y})};
}

float UniformLight::power(const Bounds3& scene) const {
  return (upper_half ? 2 : 4) * kPi * emitted.luminance() * scene_disk_area(scene);
}

std::optional<LightSample> EnvironmentLight::sample(const Point3&, Vec2 u, float) const {
  if (!importance) {
    const Vec3 w = sample_sphere_uniform(u);
    return LightSample{to_world(w), kInfinity, look_locally(w).radiance, sphere_uniform_pdf()};
  }
  const TexelDistribution::Sample texel = distribution.sample(u);
  const Vec3 w = uv_to_direction(orientation, texel.uv);
  const float pdf = uv_to_solid_angle(texel.pdf, w);
  if (!(pdf > 0)) return std::nullopt;
  return LightSample{to_world(w), kInfinity, lookup_bilinear(map, texel.uv, orientation.rows()) * intensity, pdf};
}

InfiniteView EnvironmentLight::look(const Vec3& wi) const { return look_locally(turned ? axes.to_local(wi) : wi); }

InfiniteView EnvironmentLight::look_locally(const Vec3& wi) const {
  const Vec2 uv = direction_to_uv(orientation, wi);
  const float pdf = importance ? uv_to_solid_angle(distribution.pdf(uv), wi) : sphere_uniform_pdf();
  return {lookup_bilinear(map, uv, orientation.rows()) * intensity, pdf};
}

float EnvironmentLight::power(const Bounds3& scene) const {
  const Image means = lookup_means(map, orientation.rows());
  double sum = 0;
  for (int y = 0; y < means.height(); ++y)
    for (int x = 0; x < means.width(); ++x) sum += means.at(x, y).luminance() * row_solid_angle(y, means.height());
  return 2 * kPi * intensity * static_cast<float>(sum / means.width()) * scene_disk_area(scene);
}

}  // namespace etendue
