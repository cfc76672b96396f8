#pragma once

#include <variant>

#include "materials/bsdf_model.h"
#include "materials/microfacet.h"
#include "materials/plastic_boundary.h"
#include "materials/principled.h"
#include "materials/principled_thin.h"

/// The list of BSDFs. Each works from both sides: those that let nothing through look the same from behind, boundaries
/// between the outside (z > 0) and an inside do not. An `ior` is the index inside / outside.
namespace etendue {

/// What of a BSDF is reflection by rough metal.
struct Gloss {
  float share = 0;  ///< of its luminance
  float width = 0;  ///< the microfacets'
};

/// Lambertian reflection.
struct DiffuseBsdf {
  Spectrum reflectance;

  BsdfEval eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const { return reflectance; }
  static constexpr bool is_delta() { return false; }
  static constexpr bool transmits() { return false; }
};

/// Mirror: a smooth metal, or perfect.
struct MirrorBsdf {
  Spectrum reflectance;   ///< tint
  Spectrum eta{0}, k{0};  ///< complex index of refraction; both 0: reflects everything

  BsdfEval eval(const Vec3&, const Vec3&, TransportMode) const { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const;
  static constexpr bool is_delta() { return true; }
  static constexpr bool transmits() { return false; }

 private:
  Spectrum share(float cosine) const;
};

/// How a smooth boundary divides light between reflection and refraction.
enum class Boundary {
  fresnel,        ///< by Fresnel's equations
  schlick,        ///< by Schlick's approximation
  transmit_only,  ///< all is refracted; what would be totally reflected is absorbed
  thin,  ///< two boundaries by Fresnel's equations and all that goes to and fro between them; what gets through goes
         ///< straight on
};

/// Smooth dielectric boundary.
struct DielectricBsdf {
  Spectrum reflectance, transmittance;  ///< tints
  float ior = 1.5f;
  Boundary boundary = Boundary::fresnel;

  BsdfEval eval(const Vec3&, const Vec3&, TransportMode) const { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const { return boundary == Boundary::transmit_only ? transmittance : Spectrum(1); }
  /// That sample() reflects, for every `choice` below it; it refracts for all others.
  float reflection_probability(const Vec3& wo) const;
  /// Share of the light from behind that a thin pane lets straight through to wo.
  Spectrum straight_through(const Vec3& wo) const;
  static constexpr bool is_delta() { return true; }
  static constexpr bool transmits() { return true; }

 private:
  float eta_from(const Vec3& wo) const;  ///< index beyond / before
};

/// Rough metal: single scattering from microfacets, f = F G D / (4 cos θo cos θi) (Walter et al. 2007, eq. 20).
struct ConductorBsdf {
  Spectrum eta, k;       ///< complex index of refraction
  Spectrum reflectance;  ///< tint
  MicrofacetDistribution microfacets{MicrofacetKind::beckmann, 0.1f};

  BsdfEval eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const;
  /// Whether a lamp's light that it reflects is bright in some places and dark in others.
  bool gleams() const { return microfacets.widest() < kWidestGleam; }
  static constexpr bool is_delta() { return false; }
  static constexpr bool transmits() { return false; }

 private:
  static constexpr float kWidestGleam = 0.4f;
};

/// Rough dielectric boundary: single scattering from microfacets that reflect and refract (Walter et al. 2007, eqs. 20
/// and 21).
struct RoughDielectricBsdf {
  Spectrum reflectance, transmittance;  ///< tints
  float ior = 1.5f;                     ///< moved away from 1 where refraction would be too little for float arithmetic
  MicrofacetDistribution microfacets{MicrofacetKind::beckmann, 0.1f};

  BsdfEval eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const { return Spectrum(1); }
  static constexpr bool is_delta() { return false; }
  static constexpr bool transmits() { return true; }
};

/// Diffuse base under a dielectric boundary, smooth or rough, with all that goes to and fro between them: what enters
/// and leaves is f = T(θo) T(θi) d / (π ior² (1 − R d)), R = the boundary's internal reflectance. Mitsuba's plastic and
/// roughplastic; what is reflected inside again and again is Saunderson's series (1942).
struct PlasticBsdf {
  Spectrum diffuse;                 ///< colour of the base, d
  Spectrum specular;                ///< tint of the boundary's outer reflection
  const PlasticBoundary* boundary;  ///< lives as long as the scene
  bool nonlinear = false;           ///< else R instead of R d: the base's colour is kept

  BsdfEval eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const;
  static constexpr bool is_delta() { return false; }
  static constexpr bool transmits() { return false; }

 private:
  float specular_probability(float transmittance) const;
};

/// Absorbs everything.
struct BlackBsdf {
  BsdfEval eval(const Vec3&, const Vec3&, TransportMode) const { return {}; }
  std::optional<BsdfSample> sample(const Vec3&, Vec2, float, TransportMode) const { return std::nullopt; }
  Spectrum albedo() const { return Spectrum(0); }
  static constexpr bool is_delta() { return true; }
  static constexpr bool transmits() { return false; }
};

/// The one list of BSDFs. At most 11, so that a visit is a switch.
template <typename... More>
using BsdfVariant = std::variant<DiffuseBsdf, MirrorBsdf, DielectricBsdf, ConductorBsdf, RoughDielectricBsdf,
                                 PlasticBsdf, PrincipledBsdf, PrincipledThinBsdf, BlackBsdf, More...>;
using LeafBsdf = BsdfVariant<>;

/// `second` with probability `weight`, else `first`.
struct BlendBsdf {
  LeafBsdf first, second;
  float weight = 0.5f;

  BsdfEval eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const;
  Gloss gloss() const;  ///< the brighter one
  bool is_delta() const;
  bool transmits() const;
  Spectrum straight_through(const Vec3& wo) const;
};

using Bsdf = BsdfVariant<BlendBsdf>;

BsdfEval eval_bsdf(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance);
std::optional<BsdfSample> sample_bsdf(const Bsdf& bsdf, const Vec3& wo, Vec2 u, float choice,
                                      TransportMode mode = TransportMode::radiance);
/// True if only delta lobes are there: sampling lights is in vain.
inline bool is_delta(const Bsdf& bsdf) {
  return std::visit([](const auto& b) { return b.is_delta(); }, bsdf);
}
/// True if eval_bsdf may be positive for directions on different sides: lights behind the surface count.
inline bool transmits(const Bsdf& bsdf) {
  return std::visit([](const auto& b) { return b.transmits(); }, bsdf);
}
Spectrum albedo(const Bsdf& bsdf);
Gloss gloss(const Bsdf& bsdf);
/// Share of the light from −wo that comes straight through to wo, what Lobe::straight samples: 0 but for thin panes.
Spectrum straight_through(const Bsdf& bsdf, const Vec3& wo);

}  // namespace etendue
