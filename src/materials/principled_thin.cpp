#include "materials/principled_thin.h"

#include "materials/directions.h"
#include "materials/fresnel.h"
#include "sampling/warp.h"

namespace etendue {

using namespace principled;

namespace {

/// Glass lets through to wi what its mirrored microfacets would reflect, but only on the far side of each of them.
bool passes(const Vec3& wi, const Vec3& m) {
  return dot(wi, m) < 0;
}

}  // namespace

PrincipledThinBsdf::PrincipledThinBsdf(const PrincipledThinParameters& p)
    : reflecting_(microfacets(unit(p.roughness), unit(p.anisotropic))),
      // Going through both faces scatters according to the index (Burley 2015, figure 15).
      transmitting_(microfacets((0.65f * p.eta - 0.35f) * unit(p.roughness), unit(p.anisotropic))),
      eta_(p.eta),
      specular_reflection_rate_(std::max(p.specular_reflection_rate, 0.0f)),
      specular_transmission_rate_(std::max(p.specular_transmission_rate, 0.0f)),
      diffuse_rate_(std::max(p.diffuse_rate, 0.0f)),
      diffuse_transmission_rate_(std::max(p.diffuse_transmission_rate, 0.0f)) {
  const Spectrum base = not_negative(p.base_color);
  const float glass = unit(p.spec_trans), tinted = unit(p.spec_tint), through = unit(0.5f * p.diff_trans);
  const float normal = square((eta_ - 1) / (eta_ + 1));
  fresnel_ = {glass * (1 - tinted), tint(base) * (glass * tinted * normal), glass * tinted};
  transmission_ = base * glass;
  const float back = (1 - glass) * (1 - through);
  diffuse_ = {base * back, sheen_colour(base, p.sheen_tint) * (unit(p.sheen) * back), unit(p.roughness),
              unit(p.flatness)};
  diffuse_transmission_ = base * ((1 - glass) * through);
}

/// Without a boundary there is no reflection even along it.
float PrincipledThinBsdf::exact_fresnel(float cosine) const {
  return eta_ == 1 ? 0.0f : fresnel_dielectric(cosine, eta_);
}

PrincipledThinBsdf::Probabilities PrincipledThinBsdf::probabilities(float cos_o) const {
  const float exact = exact_fresnel(cos_o);
  const float glass = fresnel_.dielectric + fresnel_.grazing;
  const float diffuse = diffuse_rate_ * diffuse_.strength();
  const float diffuse_transmission = diffuse_transmission_rate_ * diffuse_transmission_.average();
  // Microfacets may let light through where the surface as a whole would reflect totally.
  const float transmission = specular_transmission_rate_ * transmission_.average() * (1.1f - exact);
  const float least = kLeastGloss * glass * (diffuse + diffuse_transmission + transmission);
  const float reflection = specular_reflection_rate_ * std::max(fresnel_(cos_o, eta_, exact).average(), least);
  const float sum = reflection + transmission + diffuse + diffuse_transmission;
  if (!(sum > 0)) return {};
  return {reflection / sum, transmission / sum, diffuse / sum, diffuse_transmission / sum};
}

BsdfEval PrincipledThinBsdf::eval(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (std::abs(wo.z) < kGrazing || wi.z == 0) return {};
  const Vec3 above = wo.z > 0 ? wo : mirrored(wo), from = wo.z > 0 ? wi : mirrored(wi);
  return from.z > 0 ? eval_reflection(above, from) : eval_transmission(above, from);
}

BsdfEval PrincipledThinBsdf::eval_reflection(const Vec3& wo, const Vec3& wi) const {
  const Probabilities p = probabilities(wo.z);
  BsdfEval out{diffuse_.f_cos(wo, wi), p.diffuse * hemisphere_cosine_pdf(wi)};
  const Vec3 sum = wo + wi;
  const float cosine = 0.5f * length(sum);  // of half the angle between them
  const Vec3 m = sum / (2 * cosine);
  // F G D / (4 cos θo) (Walter et al. 2007, eq. 20), of which G₁(wo) D / (4 cos θo) is the density.
  const float visible = reflecting_.visible_pdf(wo, m) / (4 * cosine);
  out.f_cos += fresnel_(cosine, eta_, exact_fresnel(cosine)) * (visible * reflecting_.visibility(wi));
  out.pdf += p.reflection * visible;
  return out;
}

BsdfEval PrincipledThinBsdf::eval_transmission(const Vec3& wo, const Vec3& wi) const {
  const Probabilities p = probabilities(wo.z);
  const float lambert = hemisphere_cosine_pdf(-wi);
  BsdfEval out{diffuse_transmission_ * lambert, p.diffuse_transmission * lambert};
  const Vec3 above = mirrored(wi), sum = wo + above;
  const float cosine = 0.5f * length(sum);
  const Vec3 m = sum / (2 * cosine);
  if (!passes(wi, m)) return out;
  const float visible = transmitting_.visible_pdf(wo, m) / (4 * cosine);
  out.f_cos += transmission_ * ((1 - exact_fresnel(cosine)) * visible * transmitting_.visibility(above));
  out.pdf += p.transmission * visible;
  return out;
}

std::optional<BsdfSample> PrincipledThinBsdf::sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const {
  if (std::abs(wo.z) < kGrazing) return std::nullopt;
  const Vec3 above = wo.z > 0 ? wo : mirrored(wo);
  const Probabilities p = probabilities(above.z);
  Vec3 wi;  // as if it were reflected
  Lobe lobe;
  if (choice < p.diffuse + p.diffuse_transmission) {
    lobe = choice < p.diffuse ? Lobe::diffuse : Lobe::diffuse_transmission;
    wi = sample_hemisphere_cosine(u);
  } else {
    const bool reflects = choice < p.diffuse + p.diffuse_transmission + p.reflection;
    lobe = reflects ? Lobe::glossy : Lobe::glossy_transmission;
    const Vec3 m = (reflects ? reflecting_ : transmitting_).sample_visible(above, u);
    wi = reflected(above, m);
    if (!reflects && !passes(mirrored(wi), m)) return std::nullopt;
  }
  if (!(wi.z > 0)) return std::nullopt;
  const Vec3 from = is_transmission(lobe) == (wo.z > 0) ? mirrored(wi) : wi;
  const BsdfEval at = eval(wo, from, mode);
  if (!(at.pdf > 0)) return std::nullopt;
  return BsdfSample{from, at.f_cos / at.pdf, at.pdf, lobe};
}

Spectrum PrincipledThinBsdf::albedo() const {
  const float exact = exact_fresnel(1);
  return diffuse_.colour + diffuse_transmission_ + fresnel_(1, eta_, exact) + transmission_ * (1 - exact);
}

}  // namespace etendue
