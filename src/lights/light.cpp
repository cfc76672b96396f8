#include "lights/light.h"

namespace etendue {

std::optional<LightSample> PointLight::sample(const Point3& from, Vec2, float) const {
  const Vec3 d = position - from;
  const float d2 = length_squared(d);
  if (!(d2 > 0)) return std::nullopt;
  const float distance = std::sqrt(d2);
  return LightSample{d * (1 / distance), distance, intensity / d2, 1, true};
}

float PointLight::power(const Bounds3&) const {
  return 4 * kPi * intensity.luminance();
}

namespace {

template <typename... Models>
constexpr bool all_are_models(const std::variant<Models...>*) {
  return (LightModel<Models> && ...);
}
static_assert(all_are_models(static_cast<const Light*>(nullptr)));

}  // namespace

std::optional<LightSample> sample_light(const Light& light, const Point3& from, Vec2 u, float choice) {
  return std::visit([&](const auto& l) { return l.sample(from, u, choice); }, light);
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
