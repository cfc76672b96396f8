#include "image/false_color.h"

#include <array>

#include "image/io.h"

namespace etendue {
namespace {

float clamp_unit(float t) {
  return t > 0 ? std::min(t, 1.0f) : 0.0f;
}

/// Through evenly spaced sRGB-encoded colours, straight from each to the next.
template <std::size_t N>
Spectrum ramp(const std::array<Spectrum, N>& colors, float t) {
  const float position = clamp_unit(t) * static_cast<float>(N - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(position), N - 2);
  const float share = position - static_cast<float>(below);
  const Spectrum encoded = colors[below] * (1 - share) + colors[below + 1] * share;
  return {srgb_to_linear(encoded.r), srgb_to_linear(encoded.g), srgb_to_linear(encoded.b)};
}

}  // namespace

Spectrum rate_color(float t) {
  static constexpr std::array kColors = {Spectrum(0, 0, 1), Spectrum(0, 1, 0), Spectrum(1, 0, 0)};
  return ramp(kColors, t);
}

Spectrum heat_color(float t) {
  // Chosen so that CIE L* goes 0, 20, 40, 60, 80, 97.
  static constexpr std::array kColors = {Spectrum(0, 0, 0),
                                         Spectrum(0.26f, 0.09f, 0.45f),
                                         Spectrum(0.62f, 0.15f, 0.50f),
                                         Spectrum(0.94f, 0.36f, 0.34f),
                                         Spectrum(0.99f, 0.70f, 0.40f),
                                         Spectrum(1.0f, 0.98f, 0.78f)};
  return ramp(kColors, t);
}

Image heat_map(std::span<const float> values, int width, int height) {
  Image image(width, height);
  std::ranges::transform(values, image.pixels().begin(), heat_color);
  return image;
}

}  // namespace etendue
