#include "materials/bsdf.h"

#include "sampling/warp.h"

namespace etendue {
namespace {

template <typename... Models>
constexpr bool all_are_models(const std::variant<Models...>*) {
  return (BsdfModel<Models> && ...);
}
static_assert(all_are_models(static_cast<const Bsdf*>(nullptr)));
static_assert(std::variant_size_v<Bsdf> <= 11);
static_assert(std::is_trivially_copyable_v<Bsdf>);

}  // namespace

BsdfEval DiffuseBsdf::eval(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (wo.z * wi.z <= 0) return {};
  const float pdf = std::abs(wi.z) * kInvPi;
  return {reflectance * pdf, pdf};
}

std::optional<BsdfSample> DiffuseBsdf::sample(const Vec3& wo, Vec2 u, float, TransportMode) const {
  Vec3 wi = sample_hemisphere_cosine(u);
  const float pdf = wi.z * kInvPi;
  if (wo.z == 0 || pdf == 0) return std::nullopt;
  if (wo.z < 0) wi.z = -wi.z;
  return BsdfSample{wi, reflectance, pdf, Lobe::diffuse};
}

BsdfEval eval_bsdf(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode) {
  return std::visit([&](const auto& b) { return b.eval(wo, wi, mode); }, bsdf);
}

std::optional<BsdfSample> sample_bsdf(const Bsdf& bsdf, const Vec3& wo, Vec2 u, float choice, TransportMode mode) {
  return std::visit([&](const auto& b) { return b.sample(wo, u, choice, mode); }, bsdf);
}

Spectrum albedo(const Bsdf& bsdf) {
  return std::visit([](const auto& b) { return b.albedo(); }, bsdf);
}

Gloss gloss(const Bsdf& bsdf) {
  if (const auto* metal = std::get_if<ConductorBsdf>(&bsdf)) return {1, metal->microfacets.widest()};
  if (const auto* blend = std::get_if<BlendBsdf>(&bsdf)) return blend->gloss();
  return {};
}

Spectrum straight_through(const Bsdf& bsdf, const Vec3& wo) {
  if (const auto* glass = std::get_if<DielectricBsdf>(&bsdf)) return glass->straight_through(wo);
  if (const auto* blend = std::get_if<BlendBsdf>(&bsdf)) return blend->straight_through(wo);
  return Spectrum(0);
}

}  // namespace etendue
