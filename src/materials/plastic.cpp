#include "materials/bsdf.h"
#include "materials/directions.h"
#include "materials/fresnel.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

/// What a rough boundary does with light from outside and from inside, both at the same angle.
struct Shares {
  double let_in = 0, kept_inside = 0;
};

/// At one facet with the normal `m`, seen from `w`.
Shares shares_at(const MicrofacetDistribution& microfacets, const Vec3& w, const Vec3& m, float ior) {
  const float cosine = std::max(dot(w, m), 0.0f);
  Shares out;
  if (const std::optional<Vec3> in = refracted(w, m, ior); in && in->z < 0)
    out.let_in = (1 - fresnel_dielectric(cosine, ior)) * microfacets.visibility(*in);
  if (const Vec3 back = reflected(w, m); back.z > 0)
    out.kept_inside = fresnel_dielectric(cosine, 1 / ior) * microfacets.visibility(back);
  return out;
}

/// The mean over the facets that are seen from `w`, each as much as it is seen. The square of random numbers is looked
/// at more closely at its edges, where the steepest facets are: at (1 − cos πx) / 2 for evenly spaced x.
Shares mean_shares(const MicrofacetDistribution& microfacets, const Vec3& w, float ior) {
  constexpr int kSide = 32;
  constexpr auto node = [](int i) { return kPi * (static_cast<float>(i) + 0.5f) / kSide; };
  Shares sum;
  double total = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Vec2 u(0.5f - 0.5f * std::cos(node(x)), 0.5f - 0.5f * std::cos(node(y)));
      const double weight = std::sin(node(x)) * std::sin(node(y));
      const Shares here = shares_at(microfacets, w, microfacets.sample_visible(w, u), ior);
      sum.let_in += weight * here.let_in;
      sum.kept_inside += weight * here.kept_inside;
      total += weight;
    }
  return {sum.let_in / total, sum.kept_inside / total};
}

/// Share of diffuse light that a smooth boundary reflects; `eta` as for fresnel_dielectric.
float diffuse_fresnel_reflectance(float eta) {
  constexpr int kPoints = 1 << 12;
  double sum = 0;
  for (int i = 0; i < kPoints; ++i) {
    const float cosine = (static_cast<float>(i) + 0.5f) / kPoints;
    sum += 2 * cosine * fresnel_dielectric(cosine, eta);
  }
  return static_cast<float>(sum / kPoints);
}

}  // namespace

PlasticBoundary::PlasticBoundary(float ior) : ior_(ior), internal_reflectance_(diffuse_fresnel_reflectance(1 / ior)) {}

PlasticBoundary::PlasticBoundary(float ior, const MicrofacetDistribution& microfacets)
    : ior_(ior), microfacets_(microfacets) {
  // The internal reflectance is the plain mean over the table's cosines, both ends included, as in the model whose
  // pictures are to be met: 1 to 2 % less than the integral.
  double inside = 0;
  for (int i = 0; i < kEntries; ++i) {
    const float cosine = std::max(static_cast<float>(i) / (kEntries - 1), 1e-6f);
    const Vec3 w(safe_sqrt(1 - square(cosine)), 0, cosine);
    const Shares shares = mean_shares(microfacets, w, ior);
    transmittance_[static_cast<std::size_t>(i)] = static_cast<float>(shares.let_in);
    inside += 2 * cosine * shares.kept_inside;
  }
  internal_reflectance_ = static_cast<float>(inside / kEntries);
}

float PlasticBoundary::transmittance(float cosine) const {
  if (!microfacets_) return 1 - fresnel_dielectric(cosine, ior_);
  const float x = cosine * (kEntries - 1);
  const int i = std::clamp(static_cast<int>(x), 0, kEntries - 2);
  const auto at = transmittance_.begin() + i;
  return lerp(x - static_cast<float>(i), at[0], at[1]);
}

/// With which sample() takes the boundary's reflection: as bright as it is against the base.
float PlasticBsdf::specular_probability(float transmittance) const {
  const float outer = (1 - transmittance) * specular.average(), inner = transmittance * diffuse.average();
  return outer > 0 ? outer / (outer + inner) : 0.0f;
}

BsdfEval PlasticBsdf::eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const {
  if (wo.z * wi.z <= 0) return {};
  if (wo.z < 0) return eval(mirrored(wo), mirrored(wi), mode);
  const float transmittance = boundary->transmittance(wo.z);
  const float specular_share = specular_probability(transmittance);
  const float cosine_pdf = wi.z * kInvPi;
  const Spectrum trapped = (nonlinear ? diffuse : Spectrum(1)) * boundary->internal_reflectance();
  const float through = transmittance * boundary->transmittance(wi.z) / square(boundary->ior());
  BsdfEval out{diffuse / (Spectrum(1) - trapped) * (through * cosine_pdf), (1 - specular_share) * cosine_pdf};
  if (!boundary->microfacets()) return out;
  const std::optional<Vec3> m = half_vector(wo, wi, 1);
  if (!m) return out;
  const float cosine = dot(wo, *m);
  const float density = boundary->microfacets()->visible_pdf(wo, *m) / (4 * cosine);
  out.f_cos +=
      specular * (fresnel_dielectric(cosine, boundary->ior()) * boundary->microfacets()->visibility(wi) * density);
  out.pdf += specular_share * density;
  return out;
}

std::optional<BsdfSample> PlasticBsdf::sample(const Vec3& wo_in, Vec2 u, float choice, TransportMode mode) const {
  if (wo_in.z == 0) return std::nullopt;
  const bool back = wo_in.z < 0;
  const Vec3 wo = back ? mirrored(wo_in) : wo_in;
  const float transmittance = boundary->transmittance(wo.z);
  const float specular_share = specular_probability(transmittance);
  const bool outer = choice < specular_share;
  if (outer && !boundary->microfacets())
    return BsdfSample{reflected(wo_in), specular * ((1 - transmittance) / specular_share), 0, Lobe::delta_reflection};
  const Vec3 wi = outer ? reflected(wo, boundary->microfacets()->sample_visible(wo, u)) : sample_hemisphere_cosine(u);
  if (wi.z <= 0) return std::nullopt;
  const BsdfEval value = eval(wo, wi, mode);
  if (!(value.pdf > 0)) return std::nullopt;
  return BsdfSample{back ? mirrored(wi) : wi, value.f_cos / value.pdf, value.pdf, outer ? Lobe::glossy : Lobe::diffuse};
}

Spectrum PlasticBsdf::albedo() const {
  const float transmittance = boundary->transmittance(1);
  return specular * (1 - transmittance) + diffuse * transmittance;
}

}  // namespace etendue
