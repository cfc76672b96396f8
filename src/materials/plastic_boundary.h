#pragma once

#include <array>
#include <optional>

#include "materials/microfacet.h"

namespace etendue {

/// Dielectric boundary above a diffuse base: what goes through it and what stays below. A compiled material owns it,
/// its BSDFs refer to it. Rough ones are tabulated, which takes some milliseconds.
class PlasticBoundary {
 public:
  /// Smooth, of index inside / outside `ior`: Fresnel's equations.
  explicit PlasticBoundary(float ior);
  /// Rough and isotropic: single scattering from microfacets.
  PlasticBoundary(float ior, const MicrofacetDistribution& microfacets);

  float ior() const { return ior_; }
  /// Nothing if smooth.
  const std::optional<MicrofacetDistribution>& microfacets() const { return microfacets_; }
  /// Share of the light that arrives from outside at the cosine ≥ 0, and gets in.
  float transmittance(float cosine) const;
  /// Share of diffuse light from inside that comes back.
  float internal_reflectance() const { return internal_reflectance_; }

 private:
  static constexpr int kEntries = 64;

  float ior_;
  std::optional<MicrofacetDistribution> microfacets_;
  std::array<float, kEntries> transmittance_{};  ///< at evenly spaced cosines from 0 to 1; rough only
  float internal_reflectance_;
};

}  // namespace etendue
