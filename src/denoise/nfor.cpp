#include "denoise/nfor.h"

#include <algorithm>

#include "denoise/features.h"

namespace etendue {
namespace {

constexpr Window kWindow{6, 1};
constexpr std::array<float, kBandwidths> kBothBandwidths = {1.0f, 0.5f};
constexpr int kNoiseRadius = 4;

/// What the spread of the samples has to be multiplied with to be the noise. The spread knows each pixel but not how
/// much less noise well spread samples make; how far the halves differ knows that, but needs many pixels (Rousselle,
/// Knaus and Zwicker 2012, section 5.1).
ColorPlanes noise_of_spread(const NoisyPicture& picture) {
  const auto& [a, b] = picture.halves;
  const Image *color_a = &a.color, *color_b = &b.color, *spread_a = &a.variance, *spread_b = &b.variance;
  ColorPlanes seen = make_color_planes(color_a->width(), color_a->height(), [=](int c, int x, int y) {
    const float difference = color_a->at(x, y)[c] - color_b->at(x, y)[c];
    return difference * difference;
  });
  ColorPlanes told = make_color_planes(color_a->width(), color_a->height(), [=](int c, int x, int y) {
    return spread_a->at(x, y)[c] + spread_b->at(x, y)[c];
  });
  for (int c = 0; c < 3; ++c) {
    seen[c] = box_blurred(seen[c], kNoiseRadius);
    told[c] = box_blurred(told[c], kNoiseRadius);
  }
  return make_color_planes(color_a->width(), color_a->height(), [&](int c, int x, int y) {
    const float spread = told[c].row(y)[x];
    return spread > 0 ? std::min(1.0f, seen[c].row(y)[x] / spread) : 0.0f;
  });
}

ColorPlanes noise_variance(const PictureHalf& half, const ColorPlanes& noise) {
  return make_color_planes(half.color.width(), half.color.height(),
                           [&](int c, int x, int y) { return half.variance.at(x, y)[c] * noise[c].row(y)[x]; });
}

}  // namespace

Halves nfor(const NoisyPicture& picture, const Halves& clean, const Halves& noisy) {
  const Features features = filtered_features(picture);
  const ColorPlanes noise = noise_of_spread(picture);
  const ColorPlanes variance_a = noise_variance(picture.halves[0], noise);
  const ColorPlanes variance_b = noise_variance(picture.halves[1], noise);
  auto of_a = regressions(clean.a, features, {noisy.b, variance_b}, kWindow, kBothBandwidths);
  auto of_b = regressions(clean.b, features, {noisy.a, variance_a}, kWindow, kBothBandwidths);
  return best_mixture({std::move(of_a[0]), std::move(of_b[0])}, {std::move(of_a[1]), std::move(of_b[1])}, clean);
}

}  // namespace etendue
