#pragma once

#include "math/vec.h"

namespace etendue {

enum class MicrofacetKind { beckmann, ggx };

/// Distribution of microfacet normals about +z with Smith's shadowing, the two directions' visibilities independent
/// (Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces"). Its widths along x and y may
/// differ: it is one of width 1, stretched (Heitz 2014, "Understanding the Masking-Shadowing Function in
/// Microfacet-Based BRDFs"). Directions are unit and in the shading frame, z > 0.
class MicrofacetDistribution {
 public:
  /// Widths below this are treated as this: float arithmetic ends there.
  static constexpr float kMinAlpha = 1e-3f;

  MicrofacetDistribution(MicrofacetKind kind, float alpha) : MicrofacetDistribution(kind, alpha, alpha) {}
  MicrofacetDistribution(MicrofacetKind kind, float alpha_u, float alpha_v)
      : kind_(kind), alpha_u_(std::max(alpha_u, kMinAlpha)), alpha_v_(std::max(alpha_v, kMinAlpha)) {}

  float widest() const { return std::max(alpha_u_, alpha_v_); }

  /// D(m): density of normals per solid angle and per area of the macrosurface; ∫ D(m) (m·z) dm = 1.
  float density(const Vec3& m) const;
  /// G₁(w): visible share of the microfacets that face w. The same for −w, from below.
  float visibility(const Vec3& w) const;
  /// Density of sample_visible per solid angle of m: G₁(w) max(0, w·m) D(m) / w.z.
  float visible_pdf(const Vec3& w, const Vec3& m) const;
  /// A normal, in proportion to how much of it is seen from w: for GGX by Dupuy and Benyoub 2023 ("Sampling Visible GGX
  /// Normals with Spherical Caps"), for Beckmann by slopes (Heitz and d'Eon 2014), whose visible-slope distribution
  /// function is inverted by Newton steps.
  Vec3 sample_visible(const Vec3& w, Vec2 u) const;

 private:
  MicrofacetKind kind_;
  float alpha_u_, alpha_v_;
};

}  // namespace etendue
