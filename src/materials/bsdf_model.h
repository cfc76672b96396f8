#pragma once

#include <concepts>
#include <optional>

#include "math/spectrum.h"
#include "math/vec.h"

/// What every BSDF (bidirectional scattering distribution function) offers. All directions are unit, leave the surface,
/// and are in the shading frame (z = shading normal, on the front). wo points to where the light goes (known), wi to
/// where it comes from (sampled).
namespace etendue {

/// What is carried along the path: radiance is scaled by the squared ratio of the indices at a refraction, importance
/// is not (Veach 1997, section 5.2).
enum class TransportMode { radiance, importance };

struct BsdfEval {
  Spectrum f_cos;  ///< f(wo, wi) · |cos θi|
  float pdf = 0;   ///< density with which sample() gives wi, per solid angle; delta lobes are left out
};

enum class Lobe {
  diffuse,
  glossy,
  delta_reflection,
  diffuse_transmission,
  glossy_transmission,
  delta_transmission,
  straight,  ///< on as if nothing were there, or through a thin pane; not scattered
};

constexpr bool is_delta(Lobe lobe) {
  return lobe == Lobe::delta_reflection || lobe >= Lobe::delta_transmission;
}
/// Whether the lobe lies on the other side of the surface.
constexpr bool is_transmission(Lobe lobe) {
  return lobe >= Lobe::diffuse_transmission;
}

struct BsdfSample {
  Vec3 wi;
  Spectrum weight;  ///< f · |cos θi| / pdf; for delta lobes the lobe's factor / its probability
  float pdf = 0;    ///< per solid angle, of all lobes but delta ones; 0 for delta lobes
  Lobe lobe = Lobe::diffuse;
  float eta = 1;  ///< index of refraction on wi's side / on wo's side; 1 unless refracted

  bool is_delta() const { return etendue::is_delta(lobe); }
  bool is_transmission() const { return etendue::is_transmission(lobe); }
};

/// `u` picks the direction, `choice` the lobe; both uniform. No sample is nullopt: the light is absorbed. A BSDF is a
/// small value that is copied like plain data.
template <typename T>
concept BsdfModel = requires(const T& bsdf, const Vec3& w, Vec2 u, float choice, TransportMode mode) {
  { bsdf.eval(w, w, mode) } -> std::same_as<BsdfEval>;
  { bsdf.sample(w, u, choice, mode) } -> std::same_as<std::optional<BsdfSample>>;
  { bsdf.albedo() } -> std::same_as<Spectrum>;  ///< rough reflectance, for the albedo picture
  { bsdf.is_delta() } -> std::same_as<bool>;    ///< every lobe is a delta lobe: eval() is always 0
  {
    bsdf.transmits()
    }
    -> std::same_as<bool>;  ///< some light goes through: eval() may be positive where wo and wi are on different sides
};

}  // namespace etendue
