#pragma once

#include "materials/bsdf_model.h"
#include "materials/principled_lobes.h"

namespace etendue {

/// What PrincipledThinBsdf is made of at one point; all in [0, 1] unless said otherwise, and brought there.
struct PrincipledThinParameters {
  Spectrum base_color = Spectrum(0.5f);
  float roughness = 0.5f, anisotropic = 0;
  float spec_trans = 0;  ///< from diffuse to glass
  float diff_trans = 0;  ///< share of diffuse light that goes through, in halves: in [0, 2]
  float eta = 1.5f;      ///< index inside the sheet / around it, > 0
  float spec_tint = 0;   ///< how much the reflection of the glass takes on the base colour
  float sheen = 0, sheen_tint = 0;
  float flatness = 0;  ///< from diffuse to the look of subsurface scattering
  /// How often each lobe is sampled, relative to the others.
  float specular_reflection_rate = 1, specular_transmission_rate = 1, diffuse_rate = 1, diffuse_transmission_rate = 1;
};

/// Burley's material for sheets without thickness (2015) in Mitsuba's form: both sides look the same, and
/// what goes through is not bent. Not all of it conserves energy.
class PrincipledThinBsdf {
 public:
  explicit PrincipledThinBsdf(const PrincipledThinParameters& parameters);

  BsdfEval eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const;
  bool is_delta() const { return false; }
  bool transmits() const { return !(transmission_.is_black() && diffuse_transmission_.is_black()); }

 private:
  struct Probabilities {
    float reflection = 0, transmission = 0, diffuse = 0, diffuse_transmission = 0;
  };
  float exact_fresnel(float cosine) const;
  Probabilities probabilities(float cos_o) const;
  BsdfEval eval_reflection(const Vec3& wo, const Vec3& wi) const;
  BsdfEval eval_transmission(const Vec3& wo, const Vec3& wi) const;

  MicrofacetDistribution reflecting_, transmitting_;
  principled::BlendedFresnel fresnel_;
  Spectrum transmission_;  ///< where nothing is reflected
  principled::BurleyDiffuse diffuse_;
  Spectrum diffuse_transmission_;
  float eta_;
  float specular_reflection_rate_, specular_transmission_rate_, diffuse_rate_, diffuse_transmission_rate_;
};

}  // namespace etendue
