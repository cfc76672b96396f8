#include "lights/light.h"

namespace etendue {
namespace {

/// Where a lit point stands as seen from a lamp that shines along its −z.
struct Lit {
  Vec3 wi;  ///< from the point to the lamp
  float distance;
  float x, y;    ///< in the lamp's frame, on the plane at distance 1; only if it is before the lamp
  float cosine;  ///< of the angle to the lamp's axis
};

std::optional<Lit> lit_point(const Transform& frame, const Point3& from) {
  const Vec3 d = frame.origin - from;
  const float d2 = length_squared(d);
  if (!(d2 > 0)) return std::nullopt;
  const float distance = std::sqrt(d2), depth = dot(d, frame.z);
  return Lit{d * (1 / distance), distance, -dot(d, frame.x) / depth, -dot(d, frame.y) / depth, depth / distance};
}

Spectrum picture_at(const ColorSource& picture, const Textures* textures, Vec2 uv) {
  if (const Spectrum* constant = std::get_if<Spectrum>(&picture)) return *constant;
  return evaluate_color(picture, *textures, TexturePoint{uv, Point3(0), nullptr, {}});
}

/// Luminance of the picture, on average.
float mean_luminance(const ColorSource& picture, const Textures* textures) {
  constexpr int kGrid = 16;
  float sum = 0;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) {
      const Vec2 uv((static_cast<float>(i) + 0.5f) / kGrid, (static_cast<float>(j) + 0.5f) / kGrid);
      sum += picture_at(picture, textures, uv).luminance();
    }
  return sum / (kGrid * kGrid);
}

}  // namespace

std::optional<LightSample> SpotLight::sample(const Point3& from, Vec2) const {
  const std::optional<Lit> lit = lit_point(frame, from);
  if (!lit || lit->cosine < std::cos(cutoff)) return std::nullopt;
  float falloff = exponent == 0 ? 1.0f : std::pow(std::max(lit->cosine, 0.0f), exponent);
  if (beam < cutoff)
    falloff *= std::clamp((cutoff - std::acos(std::min(lit->cosine, 1.0f))) / (cutoff - beam), 0.0f, 1.0f);
  if (falloff == 0) return std::nullopt;
  const float reach = std::tan(cutoff);
  const Spectrum color = picture_at(picture, textures, {0.5f + 0.5f * lit->x / reach, 0.5f + 0.5f * lit->y / reach});
  return LightSample{lit->wi, lit->distance, intensity * color * (falloff / square(lit->distance)), 1, true};
}

float SpotLight::power(const Bounds3&) const {
  return 2 * kPi * (1 - std::cos(0.5f * (cutoff + beam))) * bounds().intensity;
}

LightBounds SpotLight::bounds() const {
  const float color = mean_luminance(picture, textures);
  return {{frame.origin, frame.origin}, {-frame.z, cutoff}, 1, intensity.luminance() * color};
}

/// A plane at distance 1 that faces the projector gets its picture's irradiance where cosine and distance are 1:
/// elsewhere the intensity that does so is irradiance / cos³, and E = intensity / distance² = irradiance / (depth² ·
/// cos).
std::optional<LightSample> ProjectorLight::sample(const Point3& from, Vec2) const {
  const std::optional<Lit> lit = lit_point(frame, from);
  if (!lit || lit->cosine <= 0 || std::abs(lit->x) > tan_half_x || std::abs(lit->y) > tan_half_y) return std::nullopt;
  const Spectrum color =
      picture_at(picture, textures, {0.5f + 0.5f * lit->x / tan_half_x, 0.5f + 0.5f * lit->y / tan_half_y});
  const float depth = lit->distance * lit->cosine;
  return LightSample{lit->wi, lit->distance, color * (scale / (square(depth) * lit->cosine)), 1, true};
}

float ProjectorLight::power(const Bounds3&) const {
  return 4 * tan_half_x * tan_half_y * bounds().intensity;
}

LightBounds ProjectorLight::bounds() const {
  const float angle = std::atan(std::hypot(tan_half_x, tan_half_y));
  return {{frame.origin, frame.origin}, {-frame.z, angle}, 1, scale * mean_luminance(picture, textures)};
}

}  // namespace etendue
