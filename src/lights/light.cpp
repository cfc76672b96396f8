#include "lights/light.h"

namespace etendue {

std::optional<LightSample> PointLight::sample(const Point3& from, Vec2) const {
  const Vec3 d = position - from;
  const float d2 = length_squared(d);
  if (!(d2 > 0)) return std::nullopt;
  const float distance = std::sqrt(d2);
  return LightSample{d * (1 / distance), distance, intensity / d2, 1, true};
}

float PointLight::power(const Bounds3&) const {
  return 4 * kPi * intensity.luminance();
}

LightBounds PointLight::bounds() const {
  return {{position, position}, DirectionCone::all(), 1, intensity.luminance()};
}

namespace {

template <typename... Models>
constexpr bool all_are_models(const std::variant<Models...>*) {
  return ((WholeLight<Models> || LightOfParts<Models>)&&...);
}
static_assert(all_are_models(static_cast<const Light*>(nullptr)));

}  // namespace

std::uint32_t part_count(const Light& light) {
  return std::visit(
      []<typename T>(const T& l) {
        if constexpr (LightOfParts<T>)
          return static_cast<std::uint32_t>(l.parts.size());
        else
          return std::uint32_t{1};
      },
      light);
}

PartChoice choose_part(const Light& light, float u) {
  return std::visit(
      [&]<typename T>(const T& l) {
        if constexpr (LightOfParts<T>) {
          const DiscreteDistribution::Sample chosen = l.parts.sample(u);
          return PartChoice{static_cast<std::uint32_t>(chosen.index), chosen.probability};
        } else {
          return PartChoice{};
        }
      },
      light);
}

float part_probability(const Light& light, std::uint32_t part) {
  return std::visit(
      [&]<typename T>(const T& l) {
        if constexpr (LightOfParts<T>)
          return l.parts.probability(part);
        else
          return 1.0f;
      },
      light);
}

std::uint32_t part_at(const Light& light, const LightHit& hit) {
  return std::visit(
      [&]<typename T>(const T& l) {
        if constexpr (LightOfParts<T>)
          return l.part_at(hit);
        else
          return std::uint32_t{0};
      },
      light);
}

std::optional<LightSample> sample_light(const Light& light, std::uint32_t part, const Point3& from, Vec2 u) {
  return std::visit(
      [&]<typename T>(const T& l) {
        if constexpr (LightOfParts<T>)
          return l.sample(part, from, u);
        else
          return l.sample(from, u);
      },
      light);
}

float light_pdf(const Light& light, const Point3& from, const LightHit& hit) {
  return std::visit(
      [&]<typename T>(const T& l) {
        if constexpr (FiniteAreaLight<T>)
          return l.pdf_hit(from, hit);
        else
          return 0.0f;
      },
      light);
}

std::optional<LightBounds> light_bounds(const Light& light, std::uint32_t part) {
  return std::visit(
      [&]<typename T>(const T& l) -> std::optional<LightBounds> {
        if constexpr (LightOfParts<T>)
          return l.bounds(part);
        else if constexpr (requires { l.bounds(); })
          return l.bounds();
        else
          return std::nullopt;
      },
      light);
}

InfiniteView look_at_infinity(const Light& light, const Vec3& wi) {
  return std::visit(
      [&]<typename T>(const T& l) {
        if constexpr (InfiniteLight<T>)
          return l.look(wi);
        else
          return InfiniteView{};
      },
      light);
}

void look_at_infinity(const Light& light, std::span<const Vec3> wi, std::span<InfiniteView> views) {
  if (const auto* environment = std::get_if<EnvironmentLight>(&light)) return environment->look(wi, views);
  for (std::size_t i = 0; i < views.size(); ++i) views[i] = look_at_infinity(light, wi[i]);
}

bool is_infinite(const Light& light) {
  return std::visit([]<typename T>(const T&) { return InfiniteLight<T>; }, light);
}

bool is_delta(const Light& light) {
  return std::visit([]<typename T>(const T&) { return T::kDelta; }, light);
}

float light_power(const Light& light, const Bounds3& scene) {
  return std::visit([&](const auto& l) { return l.power(scene); }, light);
}

}  // namespace etendue
