#pragma once

#include "materials/microfacet.h"
#include "math/spectrum.h"
#include "math/vec.h"

/// What the two principled materials have in common. "Burley 2012" is "Physically Based Shading at Disney", "Burley
/// 2015" is "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering" (SIGGRAPH courses).
namespace etendue::principled {

/// (1 − cos)⁵ (Schlick 1994).
float schlick_weight(float cosine);

/// `x` brought to [0, 1], where weights are; a colour to what is not negative.
float unit(float x);
Spectrum not_negative(const Spectrum& colour);

/// The colour without its luminance; white for black.
Spectrum tint(const Spectrum& colour);

/// White, tinted as much as said.
Spectrum sheen_colour(const Spectrum& base_color, float sheen_tint);

/// From directions whose sine to the surface is less, nothing is seen: densities would overflow.
inline constexpr float kGrazing = 1e-6f;

/// Gloss is sampled this much as often as all else, at least: it is narrow, and what it mirrors may be bright.
inline constexpr float kLeastGloss = 0.5f;

/// GGX of width roughness², drawn out along ∂p/∂u (Burley 2012, section 5.4).
MicrofacetDistribution microfacets(float roughness, float anisotropic);

/// Share that a microfacet reflects: a dielectric's by Fresnel's equations and coloured ones by Schlick's
/// approximation, weighted.
struct BlendedFresnel {
  float dielectric = 0;  ///< weight of the true dielectric
  Spectrum normal;       ///< what Schlick's ones reflect at normal incidence, …
  float grazing = 0;     ///< … and at grazing

  /// `cosine` > 0 between a direction and the microfacet, `eta` = index beyond it / index on the direction's side,
  /// `exact` = fresnel_dielectric(cosine, eta).
  Spectrum operator()(float cosine, float eta, float exact) const;
};

/// Diffuse reflection that grows backwards with roughness (Burley 2012, section 5.3), a flatter look as of subsurface
/// scattering (Burley 2015), and sheen (Burley 2012, but not divided by π, as in Mitsuba).
struct BurleyDiffuse {
  Spectrum colour;
  Spectrum sheen;
  float roughness = 0.5f;
  float flatness = 0;  ///< from diffuse (0) to subsurface (1)

  /// f · cos θi, both directions above the surface.
  Spectrum f_cos(const Vec3& wo, const Vec3& wi) const;
  /// About the share of light scattered from straight above: for choosing lobes.
  float strength() const { return colour.average() + 0.2f * sheen.average(); }
};

}  // namespace etendue::principled
