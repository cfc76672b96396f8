#include "image/flip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "math/vec.h"

namespace etendue {
namespace {

// All constants and equation numbers: Andersson et al. 2020.

constexpr std::size_t kRowsAtOnce = 16;

/// A colour in an opponent space: (lightness, red–green, blue–yellow).
using Opponent = Vec3;

/// A one-dimensional filter; the middle of the weights is the pixel itself.
using Kernel = std::vector<float>;

struct Plane {
  int width, height;
  std::vector<float> values;

  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * h) {}
  float& at(int x, int y) { return values[static_cast<std::size_t>(y) * width + x]; }
  float at(int x, int y) const { return values[static_cast<std::size_t>(y) * width + x]; }
};

template <typename PerRow>
void for_each_row(int height, const PerRow& per_row) {
  parallel_for(static_cast<std::size_t>(height), kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) per_row(static_cast<int>(y));
  });
}

/// Linear Rec. 709 to CIE XYZ, divided by the white point D65 (so white is (1, 1, 1)).
Vec3 to_relative_xyz(const Spectrum& c) {
  return {(0.4124564f * c.r + 0.3575761f * c.g + 0.1804375f * c.b) / 0.9504700f,
          0.2126729f * c.r + 0.7151522f * c.g + 0.0721750f * c.b,
          (0.0193339f * c.r + 0.1191920f * c.g + 0.9503041f * c.b) / 1.0888300f};
}

Spectrum from_relative_xyz(const Vec3& relative) {
  const float x = 0.9504700f * relative.x, y = relative.y, z = 1.0888300f * relative.z;
  return {3.2404542f * x - 1.5371385f * y - 0.4985314f * z, -0.9692660f * x + 1.8760108f * y + 0.0415560f * z,
          0.0556434f * x - 0.2040259f * y + 1.0572252f * z};
}

/// YCxCz, the linear variant of CIELAB in which contrast sensitivity was measured (Section 4.1).
Opponent to_ycxcz(const Vec3& xyz) {
  return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}

Vec3 from_ycxcz(const Opponent& c) {
  const float y = (c.x + 16) / 116;
  return {y + c.y / 500, y, y - c.z / 200};
}

/// CIELAB with the chroma scaled by lightness, since dim colours look less colourful (Hunt effect; Section 4.1).
Opponent to_hunt_lab(const Vec3& xyz) {
  const auto f = [](float t) {
    constexpr float kDelta = 6.0f / 29.0f;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29.0f;
  };
  const float lightness = 116 * f(xyz.y) - 16;
  const float scale = 0.01f * lightness;
  return {lightness, scale * 500 * (f(xyz.x) - f(xyz.y)), scale * 200 * (f(xyz.y) - f(xyz.z))};
}

float clamp_unit(float value) {
  return value > 0 ? std::min(value, 1.0f) : 0.0f;
}
Spectrum clamp_unit(const Spectrum& c) {
  return {clamp_unit(c.r), clamp_unit(c.g), clamp_unit(c.b)};
}

float gaussian(float x, float sigma) {
  return std::exp(-x * x / (2 * sigma * sigma));
}

template <typename Weight>
Kernel make_kernel(int radius, const Weight& weight) {
  Kernel kernel;
  for (int i = -radius; i <= radius; ++i) kernel.push_back(weight(static_cast<float>(i)));
  return kernel;
}

float sum(const Kernel& kernel) {
  float total = 0;
  for (const float w : kernel) total += w;
  return total;
}

/// Makes the positive weights add up to 1 and the negative ones to −1.
Kernel normalized(Kernel kernel) {
  float positive = 0, negative = 0;
  for (const float w : kernel) (w > 0 ? positive : negative) += w;
  for (float& w : kernel) w /= w > 0 ? positive : -negative;
  return kernel;
}

/// Filters rows with `along_x`, then columns with `along_y`; the border's pixels go on outside.
Plane convolve(const Plane& plane, const Kernel& along_x, const Kernel& along_y) {
  const auto weighted_sum = [](const Kernel& kernel, const auto& value) {
    const int radius = static_cast<int>(kernel.size() / 2);
    float total = 0;
    for (int i = -radius; i <= radius; ++i) total += kernel[i + radius] * value(i);
    return total;
  };
  Plane rows(plane.width, plane.height), out(plane.width, plane.height);
  for_each_row(plane.height, [&](int y) {
    for (int x = 0; x < plane.width; ++x)
      rows.at(x, y) = weighted_sum(along_x, [&](int i) { return plane.at(std::clamp(x + i, 0, plane.width - 1), y); });
  });
  for_each_row(plane.height, [&](int y) {
    for (int x = 0; x < plane.width; ++x)
      out.at(x, y) = weighted_sum(along_y, [&](int i) { return rows.at(x, std::clamp(y + i, 0, plane.height - 1)); });
  });
  return out;
}

/// One term a·√(π/b)·exp(−π²d²/b) of a channel's contrast sensitivity, d in degrees (Equation 3, Table 1).
struct SensitivityTerm {
  float a, b;
};

/// Low-pass filters a plane of an opponent channel with what the eye resolves.
Plane filter_contrast(const Plane& plane, std::span<const SensitivityTerm> terms, float pixels_per_degree) {
  constexpr float kWidestB = 0.04f;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(kWidestB / (2 * kPi * kPi)) * pixels_per_degree));
  Plane out(plane.width, plane.height);
  float total_weight = 0;
  for (const SensitivityTerm& term : terms) {
    const Kernel kernel =
        make_kernel(radius, [&](float i) { return gaussian(i / pixels_per_degree, std::sqrt(term.b / 2) / kPi); });
    const float weight = term.a * std::sqrt(kPi / term.b);
    total_weight += weight * square(sum(kernel));
    const Plane filtered = convolve(plane, kernel, kernel);
    for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] += weight * filtered.values[i];
  }
  for (float& value : out.values) value /= total_weight;
  return out;
}

/// A picture taken apart into the three channels of YCxCz.
struct OpponentPlanes {
  Plane lightness, red_green, blue_yellow;
};

OpponentPlanes to_planes(const Image& image) {
  OpponentPlanes planes{
      {image.width(), image.height()}, {image.width(), image.height()}, {image.width(), image.height()}};
  for (std::size_t i = 0; i < image.pixels().size(); ++i) {
    const Opponent c = to_ycxcz(to_relative_xyz(clamp_unit(image.pixels()[i])));
    planes.lightness.values[i] = c.x;
    planes.red_green.values[i] = c.y;
    planes.blue_yellow.values[i] = c.z;
  }
  return planes;
}

/// The colours that are left after the eye's filtering, in the space where their distance is measured.
std::vector<Opponent> perceived_colors(const OpponentPlanes& planes, float pixels_per_degree) {
  static constexpr SensitivityTerm kLightness[] = {{1, 0.0047f}}, kRedGreen[] = {{1, 0.0053f}},
                                   kBlueYellow[] = {{34.1f, 0.04f}, {13.5f, 0.025f}};
  const Plane lightness = filter_contrast(planes.lightness, kLightness, pixels_per_degree);
  const Plane red_green = filter_contrast(planes.red_green, kRedGreen, pixels_per_degree);
  const Plane blue_yellow = filter_contrast(planes.blue_yellow, kBlueYellow, pixels_per_degree);
  std::vector<Opponent> colors(lightness.values.size());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const Opponent filtered{lightness.values[i], red_green.values[i], blue_yellow.values[i]};
    const Spectrum on_screen = clamp_unit(from_relative_xyz(from_ycxcz(filtered)));
    colors[i] = to_hunt_lab(to_relative_xyz(on_screen));
  }
  return colors;
}

/// The HyAB distance, which suits large differences (Abasi et al. 2020; Equation 4).
float hyab(const Opponent& a, const Opponent& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

/// Maps a HyAB distance to [0, 1]: compressed by a power, and the large ones squeezed into the upper end (Equation 5).
float color_error(float distance) {
  constexpr float kPower = 0.7f, kKneeShare = 0.4f, kKneeValue = 0.95f;
  static const float largest =
      std::pow(hyab(to_hunt_lab(to_relative_xyz({0, 1, 0})), to_hunt_lab(to_relative_xyz({0, 0, 1}))), kPower);
  const float knee = kKneeShare * largest;
  const float powered = std::pow(distance, kPower);
  if (powered < knee) return kKneeValue * powered / knee;
  return std::min(1.0f, kKneeValue + (1 - kKneeValue) * (powered - knee) / (largest - knee));
}

/// How strong edges and points are at each pixel.
struct Features {
  std::vector<float> edges, points;
};

std::vector<float> magnitudes(const Plane& x, const Plane& y) {
  std::vector<float> out(x.values.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::hypot(x.values[i], y.values[i]);
  return out;
}

/// First and second derivatives of a Gaussian as wide as the features that the eye sees well (Section 4.2).
Features detect_features(const Plane& lightness, float pixels_per_degree) {
  constexpr float kFeatureWidth = 0.082f;  // degrees
  const float sigma = 0.5f * kFeatureWidth * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  const Kernel smooth = normalized(make_kernel(radius, [&](float x) { return gaussian(x, sigma); }));
  const Kernel edge = normalized(make_kernel(radius, [&](float x) { return -x * gaussian(x, sigma); }));
  const Kernel point =
      normalized(make_kernel(radius, [&](float x) { return (square(x / sigma) - 1) * gaussian(x, sigma); }));
  Plane unit = lightness;
  for (float& value : unit.values) value = (value + 16) / 116;
  return {magnitudes(convolve(unit, edge, smooth), convolve(unit, smooth, edge)),
          magnitudes(convolve(unit, point, smooth), convolve(unit, smooth, point))};
}

}  // namespace

FlipError flip_error(const Image& image, const Image& reference, float pixels_per_degree) {
  if (image.width() != reference.width() || image.height() != reference.height() || image.empty())
    throw Error(Failure::usage, fmt::format("the pictures cannot be compared: one is {} × {} pixels, the other {} × {}",
                                            image.width(), image.height(), reference.width(), reference.height()));
  const OpponentPlanes planes = to_planes(image), reference_planes = to_planes(reference);
  const std::vector<Opponent> colors = perceived_colors(planes, pixels_per_degree);
  const std::vector<Opponent> reference_colors = perceived_colors(reference_planes, pixels_per_degree);
  const Features features = detect_features(planes.lightness, pixels_per_degree);
  const Features reference_features = detect_features(reference_planes.lightness, pixels_per_degree);
  FlipError error{std::vector<float>(colors.size())};
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const float feature = std::max(std::abs(features.edges[i] - reference_features.edges[i]),
                                   std::abs(features.points[i] - reference_features.points[i]));
    const float feature_error = std::sqrt(std::min(1.0f, feature / std::numbers::sqrt2_v<float>));
    // A difference of colour counts the more, the more edges and points differ too (Equation 8).
    error.map[i] = std::pow(color_error(hyab(colors[i], reference_colors[i])), 1 - feature_error);
    error.mean += error.map[i];
  }
  error.mean /= static_cast<double>(error.map.size());
  return error;
}

}  // namespace etendue
