#include "materials/bsdf.h"
#include "materials/fresnel.h"

namespace etendue {
namespace {

Vec3 to_front(const Vec3& w, bool flip) { return flip ? Vec3(w.x, w.y, -w.z) : w; }

}  // namespace

BsdfEval ConductorBsdf::eval(const Vec3& wo_in, const Vec3& wi_in, TransportMode) const {
  if (wo_in.z * wi_in.z <= 0) return {};
  const Vec3 wo = to_front(wo_in, wo_in.z < 0), wi = to_front(wi_in, wo_in.z < 0);
  const Vec3 m = normalize(wo + wi);
  const float cosine = dot(wo, m);
  const float pdf = microfacets.visible_pdf(wo, m) / (4 * cosine);
  // f cos θi = F D G₁(wo) G₁(wi) / (4 cos θo), and the first part of that is pdf.
  return {reflectance * fresnel_conductor(cosine, eta, k) * (pdf * microfacets.visibility(wi)), pdf};
}

std::optional<BsdfSample> ConductorBsdf::sample(const Vec3& wo_in, Vec2 u, float, TransportMode) const {
  if (wo_in.z == 0) return std::nullopt;
  const Vec3 wo = to_front(wo_in, wo_in.z < 0);
  const Vec3 m = microfacets.sample_visible(wo, u);
  const float cosine = dot(wo, m);
  if (cosine <= 0) return std::nullopt;
  const Vec3 wi = normalize(m * (2 * cosine) - wo);
  if (wi.z <= 0) return std::nullopt;
  const float pdf = microfacets.visible_pdf(wo, m) / (4 * cosine);
  if (!(pdf > 0)) return std::nullopt;
  return BsdfSample{to_front(wi, wo_in.z < 0), reflectance * fresnel_conductor(cosine, eta, k) * microfacets.visibility(wi),
                    pdf, Lobe::glossy};
}

Spectrum ConductorBsdf::albedo() const { return reflectance * fresnel_conductor(1, eta, k); }

}  // namespace etendue
