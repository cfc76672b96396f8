#include "materials/bsdf.h"
#include "materials/directions.h"
#include "materials/fresnel.h"

namespace etendue {

BsdfEval ConductorBsdf::eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const {
  if (wo.z * wi.z <= 0) return {};
  if (wo.z < 0) return eval(mirrored(wo), mirrored(wi), mode);
  const std::optional<Vec3> m = half_vector(wo, wi, 1);
  if (!m) return {};
  const float cosine = dot(wo, *m);
  const float pdf = microfacets.visible_pdf(wo, *m) / (4 * cosine);
  // f cos θi = F D G₁(wo) G₁(wi) / (4 cos θo), and the first part of that is pdf.
  return {reflectance * fresnel_conductor(cosine, eta, k) * (pdf * microfacets.visibility(wi)), pdf};
}

std::optional<BsdfSample> ConductorBsdf::sample(const Vec3& wo_in, Vec2 u, float, TransportMode) const {
  if (wo_in.z == 0) return std::nullopt;
  const bool back = wo_in.z < 0;
  const Vec3 wo = back ? mirrored(wo_in) : wo_in;
  const Vec3 m = microfacets.sample_visible(wo, u);
  const float cosine = dot(wo, m);
  if (cosine <= 0) return std::nullopt;
  const Vec3 wi = reflected(wo, m);
  if (wi.z <= 0) return std::nullopt;
  const float pdf = microfacets.visible_pdf(wo, m) / (4 * cosine);
  if (!(pdf > 0)) return std::nullopt;
  return BsdfSample{back ? mirrored(wi) : wi,
                    reflectance * fresnel_conductor(cosine, eta, k) * microfacets.visibility(wi), pdf, Lobe::glossy};
}

Spectrum ConductorBsdf::albedo() const {
  return reflectance * fresnel_conductor(1, eta, k);
}

}  // namespace etendue
