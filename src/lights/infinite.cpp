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

std::optional<LightSample> DirectionalLight::sample(const Point3&, Vec2) const {
  return LightSample{to_light, kInfinity, irradiance, 1, true};
}

float DirectionalLight::power(const Bounds3& scene) const {
  return irradiance.luminance() * scene_disk_area(scene);
}

std::optional<LightSample> UniformLight::sample(const Point3&, Vec2 u) const {
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

std::optional<LightSample> EnvironmentLight::sample(const Point3&, Vec2 u) const {
  std::optional<LightSample> found;
  sample(std::span(&u, 1), std::span(&found, 1));
  return found;
}

void EnvironmentLight::sample(std::span<const Vec2> u, std::span<std::optional<LightSample>> samples) const {
  if (!importance) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Vec3 w = sample_sphere_uniform(u[i]);
      samples[i] = LightSample{w, kInfinity, look(w).radiance, sphere_uniform_pdf()};
    }
    return;
  }
  TexelDistribution::Sample texels[TexelDistribution::kMostAtOnce];
  Spectrum radiance[TexelDistribution::kMostAtOnce];
  distribution.sample(u, std::span(texels, samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i)
    radiance[i] = lookup_bilinear(map, texels[i].uv, orientation.rows()) * intensity;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 w = uv_to_direction(orientation, texels[i].uv);
    const float pdf = uv_to_solid_angle(texels[i].pdf, w);
    samples[i].reset();
    if (pdf > 0) samples[i] = LightSample{to_world(w), kInfinity, radiance[i], pdf};
  }
}

InfiniteView EnvironmentLight::look(const Vec3& wi) const {
  InfiniteView view;
  look(std::span(&wi, 1), std::span(&view, 1));
  return view;
}

void EnvironmentLight::look(std::span<const Vec3> wi, std::span<InfiniteView> views) const {
  Vec2 uv[TexelDistribution::kMostAtOnce];
  for (std::size_t i = 0; i < views.size(); ++i) uv[i] = direction_to_uv(orientation, to_local(wi[i]));
  for (std::size_t i = 0; i < views.size(); ++i)
    views[i].radiance = lookup_bilinear(map, uv[i], orientation.rows()) * intensity;
  for (std::size_t i = 0; i < views.size(); ++i)
    views[i].pdf = importance ? uv_to_solid_angle(distribution.pdf(uv[i]), to_local(wi[i])) : sphere_uniform_pdf();
}

float EnvironmentLight::power(const Bounds3& scene) const {
  const Image means = lookup_means(map, orientation.rows());
  double sum = 0;
  for (int y = 0; y < means.height(); ++y)
    for (int x = 0; x < means.width(); ++x) sum += means.at(x, y).luminance() * row_solid_angle(y, means.height());
  return 2 * kPi * intensity * static_cast<float>(sum / means.width()) * scene_disk_area(scene);
}

}  // namespace etendue
