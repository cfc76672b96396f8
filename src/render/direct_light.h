#pragma once

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

/// Shadow rays to one light: how many a vertex sends and how probable it is that it sends any.
struct LightPlan {
  int samples = 1;
  float choice = 1;
  float density() const { return static_cast<float>(samples) * choice; }
};

/// `light_samples`: per light and vertex; 0: one of one light, chosen by power.
inline LightPlan plan_light(const RenderScene::Data& scene, int light_samples, std::uint32_t light) {
  if (light_samples == 0) return {1, scene.light_choice.probability(light)};
  return {is_delta(scene.lights[light]) ? 1 : light_samples, 1};
}

}  // namespace etendue
