#include "materials/principled.h"

#include "materials/directions.h"
#include "materials/fresnel.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

using namespace principled;

/// Generalized Trowbridge-Reitz distribution with exponent 1 (Burley 2012, appendix B).
float gtr1_density(float alpha, const Vec3& m) {
  const float alpha2 = square(alpha);
  return (alpha2 - 1) / (kPi * std::log(alpha2) * (square(m.x) + square(m.y) + alpha2 * square(m.z)));
}

/// A normal with the density D(m) m.z (Burley 2012, appendix B).
Vec3 sample_gtr1(float alpha, Vec2 u) {
  const float alpha2 = square(alpha), phi = 2 * kPi * u.x;
  const float sin2 = unit((std::pow(alpha2, 1 - u.y) - alpha2) / (1 - alpha2)), sin = std::sqrt(sin2);
  return {sin * std::cos(phi), sin * std::sin(phi), std::sqrt(1 - sin2)};
}

/// A clear coat is shadowed like GGX of width ¼ (Burley 2012, section 5.6).
float clearcoat_shadowing(const Vec3& wo, const Vec3& wi) {
  const MicrofacetDistribution shadowing(MicrofacetKind::ggx, 0.25f);
  return shadowing.visibility(wo) * shadowing.visibility(wi);
}

/// It reflects like an index of 1.5, by Schlick with the cosine on the thinner side of what lies below it.
constexpr BlendedFresnel kClearcoatFresnel{0, Spectrum(0.04f), 1};

/// An index too near 1 hardly bends light: which microfacet did it is lost in rounding.
float refractive(float eta) {
  return std::abs(eta - 1) < 1e-3f ? 1.001f : eta;
}

}  // namespace

PrincipledBsdf::PrincipledBsdf(const PrincipledParameters& p)
    : microfacets_(microfacets(unit(p.roughness), unit(p.anisotropic))),
      clearcoat_(0.25f * unit(p.clearcoat)),
      clearcoat_alpha_(lerp(unit(p.clearcoat_gloss), 0.1f, 0.001f)),
      eta_(p.spec_trans > 0 ? refractive(p.eta) : p.eta),
      main_specular_rate_(std::max(p.main_specular_rate, 0.0f)),
      clearcoat_rate_(std::max(p.clearcoat_rate, 0.0f)),
      diffuse_rate_(std::max(p.diffuse_rate, 0.0f)) {
  const Spectrum base = not_negative(p.base_color);
  const float metal = unit(p.metallic), tinted = unit(p.spec_tint);
  const float glass = (1 - metal) * unit(p.spec_trans), opaque = (1 - metal) * (1 - unit(p.spec_trans));
  if (eta_ != 1) {  // without a boundary not even metal shines
    const float normal = square((eta_ - 1) / (eta_ + 1));
    fresnel_ = {(1 - metal) * (1 - tinted), base * metal + tint(base) * ((1 - metal) * tinted * normal),
                metal + (1 - metal) * tinted};
  }
  back_ = glass;
  transmission_ = Spectrum(std::sqrt(base.r), std::sqrt(base.g), std::sqrt(base.b)) * glass;
  diffuse_ = {base * opaque, sheen_colour(base, p.sheen_tint) * (unit(p.sheen) * (1 - metal)), unit(p.roughness),
              unit(p.flatness)};
}

std::optional<PrincipledBsdf::View> PrincipledBsdf::view_from(const Vec3& wo) const {
  const bool front = wo.z > 0;
  if (std::abs(wo.z) < kGrazing || (!front && back_ == 0)) return std::nullopt;
  return View{front ? wo : mirrored(wo), front, front ? eta_ : 1 / eta_};
}

PrincipledBsdf::Division PrincipledBsdf::divide(const View& view, float cosine) const {
  const float exact = fresnel_dielectric(cosine, view.eta);
  const Spectrum reflect = view.front ? fresnel_(cosine, view.eta, exact) : Spectrum(back_ * exact);
  const Spectrum transmit = transmission_ * (1 - exact);
  const float through = transmit.average();
  const float least = view.front ? kLeastGloss * (1 - back_) * through : 0.0f;  // glass is gloss in both directions
  return {reflect, transmit, std::max(reflect.average(), least), through};
}

PrincipledBsdf::Probabilities PrincipledBsdf::probabilities(const View& view) const {
  if (!view.front) return {0, 0, 1};
  const float diffuse = diffuse_rate_ * diffuse_.strength();
  const float clearcoat = clearcoat_rate_ * 0.5f * clearcoat_;
  const float least = kLeastGloss * (diffuse + clearcoat);
  const float gloss = eta_ == 1 ? 0.0f : main_specular_rate_ * std::max(divide(view, view.wo.z).weight(), least);
  const float sum = diffuse + clearcoat + gloss;
  if (!(sum > 0)) return {};
  return {diffuse / sum, clearcoat / sum, gloss / sum};
}

BsdfEval PrincipledBsdf::eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const {
  const std::optional<View> view = view_from(wo);
  if (!view || wi.z == 0) return {};
  const Vec3 to = view->front ? wi : mirrored(wi);
  return to.z > 0 ? eval_reflection(*view, to) : eval_transmission(*view, to, mode);
}

BsdfEval PrincipledBsdf::eval_reflection(const View& view, const Vec3& wi) const {
  const Probabilities p = probabilities(view);
  BsdfEval out;
  if (view.front) out = {diffuse_.f_cos(view.wo, wi), p.diffuse * hemisphere_cosine_pdf(wi)};
  const Vec3 sum = view.wo + wi;
  const float cosine = 0.5f * length(sum);  // of half the angle between them
  const Vec3 m = sum / (2 * cosine);
  const Division at = divide(view, cosine);
  // F G D / (4 cos θo) (Walter et al. 2007, eq. 20), of which G₁(wo) D / (4 cos θo) is the density.
  const float visible = microfacets_.visible_pdf(view.wo, m) / (4 * cosine);
  out.f_cos += at.reflected * (visible * microfacets_.visibility(wi));
  out.pdf += p.microfacets * at.reflect_probability() * visible;
  if (view.front && clearcoat_ > 0) {
    const float density = gtr1_density(clearcoat_alpha_, m);
    out.f_cos +=
        kClearcoatFresnel(cosine, view.eta, 0) * (clearcoat_ * density * clearcoat_shadowing(view.wo, wi) * wi.z);
    out.pdf += p.clearcoat * density * m.z / (4 * cosine);
  }
  return out;
}

BsdfEval PrincipledBsdf::eval_transmission(const View& view, const Vec3& wi, TransportMode mode) const {
  if (!transmits()) return {};
  const std::optional<Vec3> m = half_vector(view.wo, wi, view.eta);
  if (!m) return {};
  const float cos_o = dot(view.wo, *m), cos_i = dot(wi, *m);
  if (!(cos_o > 0 && cos_i < 0)) return {};  // no microfacet refracts like this
  const Division at = divide(view, cos_o);
  // Walter et al. 2007, eqs. 17 and 21.
  const float visible =
      microfacets_.visible_pdf(view.wo, *m) * square(view.eta) * -cos_i / square(cos_o + view.eta * cos_i);
  return {at.transmitted * (visible * microfacets_.visibility(wi) * radiance_scale(view.eta, mode)),
          probabilities(view).microfacets * (1 - at.reflect_probability()) * visible};
}

std::optional<BsdfSample> PrincipledBsdf::sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const {
  const std::optional<View> view = view_from(wo);
  if (!view) return std::nullopt;
  const Probabilities p = probabilities(*view);
  std::optional<Vec3> wi;
  Lobe lobe = Lobe::glossy;
  if (choice < p.diffuse) {
    lobe = Lobe::diffuse;
    wi = sample_hemisphere_cosine(u);
  } else if (choice < p.diffuse + p.clearcoat) {
    wi = reflected(view->wo, sample_gtr1(clearcoat_alpha_, u));
  } else {
    const Vec3 m = microfacets_.sample_visible(view->wo, u);
    const float cosine = dot(view->wo, m);
    if (!(cosine > 0)) return std::nullopt;
    const float rest = (choice - p.diffuse - p.clearcoat) / p.microfacets;
    if (rest < divide(*view, cosine).reflect_probability()) {
      wi = reflected(view->wo, m);
    } else {
      lobe = Lobe::glossy_transmission;
      wi = refracted(view->wo, m, view->eta);
    }
  }
  if (!wi || is_transmission(lobe) != (wi->z < 0)) return std::nullopt;
  const Vec3 from = view->front ? *wi : mirrored(*wi);
  const BsdfEval at = eval(wo, from, mode);
  if (!(at.pdf > 0)) return std::nullopt;
  return BsdfSample{from, at.f_cos / at.pdf, at.pdf, lobe, is_transmission(lobe) ? view->eta : 1.0f};
}

Spectrum PrincipledBsdf::albedo() const {
  const float exact = fresnel_dielectric(1, eta_);
  return diffuse_.colour + fresnel_(1, eta_, exact) + transmission_ * (1 - exact);
}

}  // namespace etendue
