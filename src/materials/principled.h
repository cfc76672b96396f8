#pragma once

#include "materials/bsdf_model.h"
#include "materials/principled_lobes.h"

namespace etendue {

/// What PrincipledBsdf is made of at one point; all in [0, 1] unless said otherwise, and brought there.
struct PrincipledParameters {
  Spectrum base_color = Spectrum(0.5f);
  float roughness = 0.5f, anisotropic = 0;
  float metallic = 0, spec_trans = 0;  ///< from diffuse over dielectric to metal or to glass
  float spec_tint = 0;                 ///< how much the dielectric's reflection takes on the base colour
  float sheen = 0, sheen_tint = 0;
  float flatness = 0;  ///< from diffuse to the look of subsurface scattering
  float clearcoat = 0, clearcoat_gloss = 0;
  float eta = 1.5f;  ///< index inside / outside, > 0
  float main_specular_rate = 1, clearcoat_rate = 1,
        diffuse_rate = 1;  ///< how often each lobe is sampled, relative to the others
};

/// Burley's material for solids (2012, 2015) in Mitsuba's form: below the surface, only glass is seen. A clear coat
/// (GTR1) over microfacets (GGX, metal and dielectric, reflecting and refracting) over a diffuse base with sheen. Not
/// all of it conserves energy.
class PrincipledBsdf {
 public:
  explicit PrincipledBsdf(const PrincipledParameters& parameters);

  BsdfEval eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const;
  Spectrum albedo() const;
  bool is_delta() const { return false; }
  bool transmits() const { return !transmission_.is_black(); }

 private:
  /// The path's view of the surface: mirrored so that wo is above it.
  struct View {
    Vec3 wo;
    bool front;
    float eta;  ///< index on the far side / index on wo's side
  };
  /// How a microfacet divides light, and how often sample() chooses either way there, relative to each other and to
  /// other lobes.
  struct Division {
    Spectrum reflected, transmitted;
    float reflect_weight, transmit_weight;

    float weight() const { return reflect_weight + transmit_weight; }
    float reflect_probability() const { return weight() > 0 ? reflect_weight / weight() : 1.0f; }
  };
  struct Probabilities {
    float diffuse = 0, clearcoat = 0, microfacets = 0;
  };

  std::optional<View> view_from(const Vec3& wo) const;
  Division divide(const View& view, float cosine) const;
  Probabilities probabilities(const View& view) const;
  BsdfEval eval_reflection(const View& view, const Vec3& wi) const;
  BsdfEval eval_transmission(const View& view, const Vec3& wi, TransportMode mode) const;

  MicrofacetDistribution microfacets_;
  principled::BlendedFresnel fresnel_;  ///< from the front
  float back_;                          ///< weight of the dielectric reflection from inside
  Spectrum transmission_;
  principled::BurleyDiffuse diffuse_;
  float clearcoat_, clearcoat_alpha_;
  float eta_;
  float main_specular_rate_, clearcoat_rate_, diffuse_rate_;
};

}  // namespace etendue
