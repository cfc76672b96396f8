#include "denoise/outliers.h"

#include <algorithm>

namespace etendue {
namespace {

constexpr int kRadius = 2, kAround = 2 * (2 * kRadius + 1) * (2 * kRadius + 1) - 1;
constexpr int kNearlyAll = kAround * 95 / 100;
constexpr float kMostAbove = 3;

Plane luminance(const ColorPlanes& color) {
  return make_plane(color[0].width(), color[0].height(), [&](int x, int y) {
    const float sum = 0.2126f * color[0].row(y)[x] + 0.7152f * color[1].row(y)[x] + 0.0722f * color[2].row(y)[x];
    return std::max(0.0f, sum);
  });
}

/// What nearly all pixels around (x, y), itself left out in `mine`, do not exceed.
float bright_around(const Plane& mine, const Plane& other, int x, int y) {
  float values[kAround];
  float* end = values;
  for (int dy = -kRadius; dy <= kRadius; ++dy)
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      *end++ = other.row(y + dy)[x + dx];
      if (dx != 0 || dy != 0) *end++ = mine.row(y + dy)[x + dx];
    }
  std::nth_element(values, values + kNearlyAll, end);
  return values[kNearlyAll];
}

ColorPlanes limited(const ColorPlanes& color, const Plane& mine, const Plane& other) {
  const Plane scale = make_plane(mine.width(), mine.height(), [&](int x, int y) {
    const float value = mine.row(y)[x];
    if (value <= kMostAbove * other.row(y)[x]) return 1.0f;
    const float limit = kMostAbove * std::max(other.row(y)[x], bright_around(mine, other, x, y));
    return value > limit ? limit / value : 1.0f;
  });
  return make_color_planes(mine.width(), mine.height(),
                           [&](int c, int x, int y) { return color[c].row(y)[x] * scale.row(y)[x]; });
}

}  // namespace

Halves without_outliers(const Halves& noisy) {
  const Plane a = luminance(noisy.a), b = luminance(noisy.b);
  return {limited(noisy.a, a, b), limited(noisy.b, b, a)};
}

}  // namespace etendue
