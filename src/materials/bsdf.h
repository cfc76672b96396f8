#pragma once

#include <concepts>
#include <optional>
#include <variant>

#include "materials/microfacet.h"
#include "math/spectrum.h"
#include "math/vec.h"

/// Bidirectional scattering distribution functions. All directions are unit, leave the surface, and are in the shading frame (z = shading
/// normal, on the front). wo points to where the light goes (known), wi to where it comes from (sampled).
namespace etendue {

/// What is carried along the path: radiance is scaled by the squared ratio of the indices at a refraction, importance is not
/// (Veach 1997, section 5.2).
enum class TransportMode { radiance, importance };

struct BsdfEval {
  Spectrum f_cos;  ///< f(wo, wi) · |cos θi|
  float pdf = 0;   ///< density with which sample() gives wi, per solid angle; 0 for delta lobes
};

enum class Lobe { diffuse, glossy, delta_reflection, delta_transmission };

struct BsdfSample {
  Vec3 wi;
  Spectrum weight;      ///< f · |cos θi| / pdf; for delta lobes the lobe's factor / its probability
  float pdf = 0;        ///< per solid angle; 0 for delta lobes
  Lobe lobe = Lobe::diffuse;
  float eta = 1;        ///< index of refraction on wi's side / on wo's side; 1 unless transmitted

  bool is_delta() const { return lobe == Lobe::delta_reflection || lobe == Lobe::delta_transmission; }
};

/// What every BSDF offers. `u` picks the direction, `choice` the lobe; both uniform. No sample is nullopt: the light is absorbed.
template <typename T>
concept BsdfModel = requires(const T& bsdf, const Vec3& w, Vec2 u, float choice, TransportMode mode) {
  { bsdf.eval(w, w, mode) } -> std::same_as<BsdfEval>;
  { bsdf.sample(w, u, choice, mode) } -> std::same_as<std::optional<BsdfSample>>;
  { bsdf.albedo() } -> std::same_as<Spectrum>;            ///< rough reflectance, for the albedo picture
  { T::kDelta } -> std::convertible_to<bool>;             ///< every lobe is a delta lobe: eval() is always 0
};

/// Lambertian reflection on both sides.
struct DiffuseBsdf {
  static constexpr bool kDelta = false;
  Spectrum reflectance;

  BsdfEval eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const { return reflectance; }
};

/// Perfect reflection on both sides.
struct MirrorBsdf {
  static constexpr bool kDelta = true;
  Spectrum reflectance;

  BsdfEval eval(const Vec3&, const Vec3&, TransportMode) const { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const { return reflectance; }
};

/// Smooth boundary between the outside (z > 0) and a dielectric of relative index `ior`: reflection and refraction.
struct DielectricBsdf {
  static constexpr bool kDelta = true;
  Spectrum reflectance, transmittance;  ///< tints
  float ior = 1.5f;                     ///< inside / outside
  bool schlick = false;                 ///< Fresnel by Schlick's approximation

  BsdfEval eval(const Vec3&, const Vec3&, TransportMode) const { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const { return Spectrum(1); }
};

/// The same boundary letting everything through: no Fresnel reflection; what would be totally reflected is absorbed.
struct RefractionBsdf {
  static constexpr bool kDelta = true;
  Spectrum transmittance;
  float ior = 1.5f;

  BsdfEval eval(const Vec3&, const Vec3&, TransportMode) const { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const { return transmittance; }
};

/// Rough metal on both sides: single scattering from microfacets, f = F G D / (4 cos θo cos θi) (Walter et al. 2007, eq. 20).
struct ConductorBsdf {
  static constexpr bool kDelta = false;
  Spectrum eta, k;        ///< complex index of refraction
  Spectrum reflectance;   ///< tint
  MicrofacetDistribution microfacets{MicrofacetKind::beckmann, 0.1f};

  BsdfEval eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const;
};

/// Absorbs everything.
struct BlackBsdf {
  static constexpr bool kDelta = true;

  BsdfEval eval(const Vec3&, const Vec3&, TransportMode) const { return {}; }
  std::optional<BsdfSample> sample(const Vec3&, Vec2, float, TransportMode) const { return std::nullopt; }
  Spectrum albedo() const { return Spectrum(0); }
};

/// The one list of BSDFs. At most 11, so that a visit is a switch.
using Bsdf = std::variant<DiffuseBsdf, MirrorBsdf, DielectricBsdf, RefractionBsdf, ConductorBsdf, BlackBsdf>;

BsdfEval eval_bsdf(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance);
std::optional<BsdfSample> sample_bsdf(const Bsdf& bsdf, const Vec3& wo, Vec2 u, float choice,
                                      TransportMode mode = TransportMode::radiance);
/// True if only delta lobes are there: sampling lights is in vain.
bool is_delta(const Bsdf& bsdf);
Spectrum albedo(const Bsdf& bsdf);

}  // namespace etendue
