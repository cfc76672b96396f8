#pragma once

#include <algorithm>

#include "render/scene_data.h"

/// What path integrators share of next-event estimation.
namespace etendue {

/// Power heuristic with exponent 2 (Veach 1997, eq. 9.13); densities already count the samples of each technique.
inline float mis_weight(float pdf, float other_pdf) {
  return 1 / (1 + square(other_pdf / pdf));
}

/// From `start`, beside the point `from` that sampled the light, to what was sampled: ends before the light's own
/// surface by its rounding error and that of the ray.
inline Ray shadow_ray(const Point3& start, const Point3& from, const LightSample& sample) {
  if (std::isinf(sample.distance)) return {start, sample.wi};
  const float error = sample.error + kRelativeError * max_abs_component(from);
  const Vec3 d = (from - start) + sample.wi * sample.distance + sample.normal * error;
  const float distance = length(d);
  return {start, d * (1 / distance), 0, distance};
}

/// Whether some light is a surface in the scene.
inline bool has_lamps(const RenderScene::Data& scene) {
  return std::ranges::any_of(scene.lights, [](const Light& l) { return !is_infinite(l) && !is_delta(l); });
}

/// How many samples of a light a vertex takes if it asks every light: `light_samples`, but no more than one of a light
/// that looks the same to all of them.
inline int samples_of_light(const RenderScene::Data& scene, int light_samples, std::uint32_t light) {
  return is_delta(scene.lights[light]) ? 1 : light_samples;
}

/// How many samples a vertex at `at` is expected to take of a light's part. `light_samples`: per light; 0: it takes one
/// of one part, chosen where it is.
inline float light_density(const RenderScene::Data& scene, int light_samples, const Receiver& at, std::uint32_t light,
                           std::uint32_t part) {
  if (light_samples == 0) return scene.light_choice.probability(at, light, part);
  return static_cast<float>(samples_of_light(scene, light_samples, light)) *
         part_probability(scene.lights[light], part);
}

/// A uniform number in [0, 1) of 48 random bits, from two of the sampler's.
inline double fine_uniform(Vec2 u) {
  return static_cast<double>(u.x) + static_cast<double>(u.y) * 0x1p-24;
}

}  // namespace etendue
