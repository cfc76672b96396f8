#pragma once

#include <concepts>
#include <variant>

#include "math/vec.h"

/// How media scatter light into directions. wo points to where the light goes, wi to where it comes from; both are unit
/// and leave the point, so that light that goes straight on has wi = −wo. Phase functions integrate to 1 over wi and
/// are sampled exactly: their value is the density of sample() per solid angle.
namespace etendue {

struct PhaseSample {
  Vec3 wi;
  float pdf = 0;
};

template <typename T>
concept PhaseModel = requires(const T& phase, const Vec3& w, Vec2 u) {
  { phase.eval(w, w) } -> std::same_as<float>;
  { phase.sample(w, u) } -> std::same_as<PhaseSample>;
};

/// Into every direction alike.
struct IsotropicPhase {
  float eval(const Vec3& wo, const Vec3& wi) const;
  PhaseSample sample(const Vec3& wo, Vec2 u) const;
};

/// Henyey and Greenstein 1941, eq. 2.
struct HenyeyGreensteinPhase {
  float g = 0;  ///< mean cosine of the angle by which light is turned, in (−1, 1)

  float eval(const Vec3& wo, const Vec3& wi) const;
  PhaseSample sample(const Vec3& wo, Vec2 u) const;
};

/// The one list of phase functions.
using Phase = std::variant<IsotropicPhase, HenyeyGreensteinPhase>;

float eval_phase(const Phase& phase, const Vec3& wo, const Vec3& wi);
PhaseSample sample_phase(const Phase& phase, const Vec3& wo, Vec2 u);

}  // namespace etendue
