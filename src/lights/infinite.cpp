#include <limits>

#include "lights/light.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Area of the disk that parallel light needs to cover the scene.
float scene_disk_area(const Bounds3& scene) { return kPi * square(0.5f * scene.diagonal()); }

/// The uv square maps to the sphere with Jacobian 2π² sin θ.
float uv_to_solid_angle(float pdf_uv, const Vec3& w) {
  const float sin_theta = std::sqrt(square(w.x) + square(w.z));
  return sin_theta > 0 ? pdf_uv / (2 * square(kPi) * sin_theta) : 0.0f;
}

}  // namespace

std::optional<LightSample> DirectionalLight::sample(const Point3&, Vec2) const {
  return LightSample{to_light, kInfinity, irradiance, 1, true};
}

float DirectionalLight::power(const Bounds3& scene) const { return irradiance.luminance() * scene_disk_area(scene); }

std::optional<LightSample> HemisphereLight::sample(const Point3&, Vec2 u) const {
  const Vec3 w = sample_hemisphere_uniform(u);
  return LightSample{{w.x, w.z, w.y}, kInfinity, emitted, hemisphere_uniform_pdf(w)};
}

Spectrum HemisphereLight::radiance(const Vec3& wi) const { return wi.y >= 0 ? emitted : Spectrum(0); }
float HemisphereLight::pdf_direction(const Vec3& wi) const { return hemisphere_uniform_pdf({wi.x, wi.z, wi.y}); }
float HemisphereLight::power(const Bounds3& scene) const {
  return 2 * kPi * emitted.luminance() * scene_disk_area(scene);
}

std::optional<LightSample> EnvironmentLight::sample(const Point3&, Vec2 u) const {
  if (!importance) {
    const Vec3 w = sample_sphere_uniform(u);
    return LightSample{w, kInfinity, radiance(w), sphere_uniform_pdf()};
  }
  const TexelDistribution::Sample texel = distribution.sample(u);
  const Vec3 w = uv_to_direction(orientation, texel.uv);
  const float pdf = uv_to_solid_angle(texel.pdf, w);
  if (!(pdf > 0)) return std::nullopt;
  return LightSample{w, kInfinity, lookup_bilinear(map, texel.uv, orientation.rows()) * intensity, pdf};
}

Spectrum EnvironmentLight::radiance(const Vec3& wi) const {
  return lookup_bilinear(map, direction_to_uv(orientation, wi), orientation.rows()) * intensity;
}

float EnvironmentLight::pdf_direction(const Vec3& wi) const {
  if (!importance) return sphere_uniform_pdf();
  return uv_to_solid_angle(distribution.pdf(direction_to_uv(orientation, wi)), wi);
}

float EnvironmentLight::power(const Bounds3& scene) const {
  double sum = 0, weight = 0;
  for (int y = 0; y < map.height(); ++y) {
    const double sin_theta = std::sin(std::numbers::pi * (y + 0.5) / map.height());
    for (int x = 0; x < map.width(); ++x) sum += map.at(x, y).luminance() * sin_theta;
    weight += sin_theta * map.width();
  }
  return 4 * kPi * intensity * static_cast<float>(sum / weight) * scene_disk_area(scene);
}

}  // namespace etendue
