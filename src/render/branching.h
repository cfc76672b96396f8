#pragma once

#include <algorithm>
#include <optional>

#include "materials/material.h"

/// The camera's paths go both ways at glass: the brighter one first, the other later.
namespace etendue {

/// A path branches so often at most, …
inline constexpr int kMostBranches = 3;
/// … where the darker way is worth that much of the pixel at least.
inline constexpr float kLeastBranch = 0.01f;

/// What the darker way is worth to a path with this throughput; eta_scale is the product of eta² along it, which is no
/// reason to leave light out. 0 where there are no two ways.
inline float worth_of_darker_way(const Scattering& scattering, const Spectrum& throughput, float eta_scale) {
  const float reflection = scattering.reflection_probability().value_or(0);
  return std::min(reflection, 1 - reflection) * throughput.max() * eta_scale;
}

/// One of the two ways, followed for certain: with the weight that both together need.
inline std::optional<BsdfSample> one_way(const Scattering& scattering, bool brighter) {
  const float reflection = *scattering.reflection_probability();
  const bool reflects = (reflection < 0.5f) != brighter;
  std::optional<BsdfSample> sample = scattering.sample({}, reflects ? 0.0f : kOneMinusEpsilon);
  if (sample) sample->weight *= reflects ? reflection : 1 - reflection;
  return sample;
}

}  // namespace etendue
