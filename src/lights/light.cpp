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

void sample_light(const Light& light, std::span<const Point3> from, std::span<const Vec2> u,
                  std::span<const float> choice, std::span<std::optional<LightSample>> samples) {
  std::visit(
      [&]<typename T>(const T& l) {
        if constexpr (std::is_same_v<T, EnvironmentLight>)
          l.sample(u, samples);
        else
          for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = l.sample(from[i], u[i], choice[i]);
      },
      light);
}

bool has_parts(const Light& light) {
  return std::holds_alternative<MeshLight>(light) || std::holds_alternative<TexturedMeshLight>(light);
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
