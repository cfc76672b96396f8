#include "materials/bsdf.h"

namespace etendue {

BsdfEval BlendBsdf::eval(const Vec3& wo, const Vec3& wi, TransportMode mode) const {
  const auto value = [&](const auto& bsdf) { return bsdf.eval(wo, wi, mode); };
  const BsdfEval a = std::visit(value, first), b = std::visit(value, second);
  return {a.f_cos * (1 - weight) + b.f_cos * weight, a.pdf * (1 - weight) + b.pdf * weight};
}

std::optional<BsdfSample> BlendBsdf::sample(const Vec3& wo, Vec2 u, float choice, TransportMode mode) const {
  const bool takes_second = choice < weight;
  const float again = takes_second ? choice / weight : (choice - weight) / (1 - weight);
  const std::optional<BsdfSample> sample =
      std::visit([&](const auto& bsdf) { return bsdf.sample(wo, u, std::min(again, kOneMinusEpsilon), mode); },
                 takes_second ? second : first);
  if (!sample || sample->is_delta()) return sample;  // a delta lobe's factor and its probability shrink alike
  const BsdfEval other =
      std::visit([&](const auto& bsdf) { return bsdf.eval(wo, sample->wi, mode); }, takes_second ? first : second);
  const float share = takes_second ? weight : 1 - weight;
  BsdfSample out = *sample;
  out.pdf = share * sample->pdf + (1 - share) * other.pdf;
  out.weight = (sample->weight * (share * sample->pdf) + other.f_cos * (1 - share)) / out.pdf;
  return out;
}

Spectrum BlendBsdf::albedo() const {
  const auto value = [](const auto& bsdf) { return bsdf.albedo(); };
  return std::visit(value, first) * (1 - weight) + std::visit(value, second) * weight;
}

Gloss BlendBsdf::gloss() const {
  const float whole = albedo().luminance();
  const auto of = [&](const LeafBsdf& leaf, float share) {
    const auto* metal = std::get_if<ConductorBsdf>(&leaf);
    return metal != nullptr && whole > 0
               ? Gloss{share * metal->albedo().luminance() / whole, metal->microfacets.widest()}
               : Gloss{};
  };
  const Gloss a = of(first, 1 - weight), b = of(second, weight);
  return a.share > b.share ? a : b;
}

bool BlendBsdf::is_delta() const {
  const auto value = [](const auto& bsdf) { return bsdf.is_delta(); };
  return std::visit(value, first) && std::visit(value, second);
}

bool BlendBsdf::transmits() const {
  const auto value = [](const auto& bsdf) { return bsdf.transmits(); };
  return std::visit(value, first) || std::visit(value, second);
}

Spectrum BlendBsdf::straight_through(const Vec3& wo) const {
  const auto share = [&](const LeafBsdf& leaf) {
    const auto* glass = std::get_if<DielectricBsdf>(&leaf);
    return glass != nullptr ? glass->straight_through(wo) : Spectrum(0);
  };
  return share(first) * (1 - weight) + share(second) * weight;
}

}  // namespace etendue
