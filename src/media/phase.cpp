#include "media/phase.h"

#include "math/frame.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

static_assert(PhaseModel<IsotropicPhase> && PhaseModel<HenyeyGreensteinPhase>);

/// p(cos θ) = (1 − g²) / (4π (1 + g² − 2g cos θ)^(3/2)), θ the angle by which light is turned.
float henyey_greenstein(float g, float cosine) {
  const float d = square(1 - g) + 2 * g * (1 - cosine);
  return (1 - square(g)) / (4 * kPi * d * std::sqrt(d));
}

/// The inverse of its distribution function at (1 + s) / 2, multiplied out so that nothing cancels for small g.
float henyey_greenstein_cosine(float g, float s) {
  const float numerator = 2 * s + g * (s * s + 3) + 2 * g * g * s + g * g * g * (s * s - 1);
  return std::clamp(numerator / (2 * square(1 + g * s)), -1.0f, 1.0f);
}

}  // namespace

float IsotropicPhase::eval(const Vec3&, const Vec3&) const {
  return sphere_uniform_pdf();
}
PhaseSample IsotropicPhase::sample(const Vec3&, Vec2 u) const {
  return {sample_sphere_uniform(u), sphere_uniform_pdf()};
}

float HenyeyGreensteinPhase::eval(const Vec3& wo, const Vec3& wi) const {
  return henyey_greenstein(g, -dot(wo, wi));
}

PhaseSample HenyeyGreensteinPhase::sample(const Vec3& wo, Vec2 u) const {
  const float cosine = henyey_greenstein_cosine(g, 1 - 2 * u.x);
  const float sine = safe_sqrt((1 - cosine) * (1 + cosine));
  const float phi = 2 * kPi * u.y;
  const Vec3 wi = Frame::from_normal(-wo).to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
  return {wi, henyey_greenstein(g, cosine)};
}

float eval_phase(const Phase& phase, const Vec3& wo, const Vec3& wi) {
  return std::visit([&](const auto& p) { return p.eval(wo, wi); }, phase);
}

PhaseSample sample_phase(const Phase& phase, const Vec3& wo, Vec2 u) {
  return std::visit([&](const auto& p) { return p.sample(wo, u); }, phase);
}

}  // namespace etendue
