#include "materials/bsdf.h"
#include "materials/directions.h"
#include "materials/fresnel.h"

namespace etendue {
namespace {

/// Index on the far side / on wo's side, away from 1: there directions would no longer tell which facet refracts one
/// into the other.
float relative_index(float ior, bool from_outside) {
  constexpr float kLeast = 1e-3f;
  const float distinct = std::abs(ior - 1) < kLeast ? 1 + std::copysign(kLeast, ior - 1) : ior;
  return from_outside ? distinct : 1 / distinct;
}

/// One facet of a rough dielectric and what it does to light from or to wo, which is above the surface.
class Facet {
 public:
  Facet(const RoughDielectricBsdf& bsdf, const Vec3& wo, const Vec3& m, float eta)
      : bsdf_(bsdf),
        m_(m),
        eta_(eta),
        cos_o_(dot(wo, m)),
        visible_pdf_(bsdf.microfacets.visible_pdf(wo, m)),
        fresnel_(fresnel_dielectric(std::max(cos_o_, 0.0f), eta)) {}

  float reflect_probability() const {
    const float reflect = fresnel_ * bsdf_.reflectance.max(), transmit = (1 - fresnel_) * bsdf_.transmittance.max();
    return reflect > 0 ? reflect / (reflect + transmit) : 0.0f;
  }

  /// Zero if wi and wo are on the wrong side of the facet.
  BsdfEval scattered(const Vec3& wi, TransportMode mode) const {
    const bool reflects = wi.z > 0;
    const float cos_i = dot(wi, m_);
    if (cos_o_ <= 0 || wi.z == 0 || (reflects ? cos_i <= 0 : cos_i >= 0)) return {};
    const float p = reflect_probability();
    // f cos θi = (share) G₁(wi) · density of wi, which is the facet's visible_pdf · dωm/dωi (Walter et al. 2007, eqs.
    // 14 and 17).
    const float visibility = bsdf_.microfacets.visibility(wi);
    if (reflects) {
      const float density = visible_pdf_ / (4 * cos_o_);
      return {bsdf_.reflectance * (fresnel_ * visibility * density), p * density};
    }
    const float density = visible_pdf_ * square(eta_) * -cos_i / square(cos_o_ + eta_ * cos_i);
    return {bsdf_.transmittance * ((1 - fresnel_) * visibility * density * radiance_scale(eta_, mode)),
            (1 - p) * density};
  }

 private:
  const RoughDielectricBsdf& bsdf_;
  Vec3 m_;
  float eta_;  ///< index below / above
  float cos_o_, visible_pdf_, fresnel_;
};

}  // namespace

BsdfEval RoughDielectricBsdf::eval(const Vec3& wo_in, const Vec3& wi_in, TransportMode mode) const {
  if (wo_in.z == 0) return {};
  const bool back = wo_in.z < 0;
  const Vec3 wo = back ? mirrored(wo_in) : wo_in, wi = back ? mirrored(wi_in) : wi_in;
  const float eta = relative_index(ior, !back);
  const std::optional<Vec3> m = half_vector(wo, wi, eta);
  return m ? Facet(*this, wo, *m, eta).scattered(wi, mode) : BsdfEval{};
}

std::optional<BsdfSample> RoughDielectricBsdf::sample(const Vec3& wo_in, Vec2 u, float choice,
                                                      TransportMode mode) const {
  if (wo_in.z == 0) return std::nullopt;
  const bool back = wo_in.z < 0;
  const Vec3 wo = back ? mirrored(wo_in) : wo_in;
  const float eta = relative_index(ior, !back);
  const Vec3 m = microfacets.sample_visible(wo, u);
  const Facet facet(*this, wo, m, eta);
  const bool reflects = choice < facet.reflect_probability();
  const std::optional<Vec3> wi = reflects ? reflected(wo, m) : refracted(wo, m, eta);
  if (!wi || (wi->z > 0) != reflects) return std::nullopt;
  const BsdfEval eval = facet.scattered(*wi, mode);
  if (!(eval.pdf > 0) || !std::isfinite(eval.pdf)) return std::nullopt;
  return BsdfSample{back ? mirrored(*wi) : *wi, eval.f_cos / eval.pdf, eval.pdf,
                    reflects ? Lobe::glossy : Lobe::glossy_transmission, reflects ? 1.0f : eta};
}

}  // namespace etendue
