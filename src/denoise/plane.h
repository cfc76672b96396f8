#pragma once

#include <array>
#include <vector>

#include "base/parallel.h"

namespace etendue {

/// So many pixels of a row are worked on at once: the compiler turns loops over them into vector instructions.
inline constexpr int kLanes = 16;
using Lanes = std::array<float, kLanes>;

/// One float for every pixel, with a margin that mirrors the picture, so that windows may reach over its border.
class Plane {
 public:
  static constexpr int kMargin = 16;

  Plane() = default;
  Plane(int width, int height)
      : width_(width),
        height_(height),
        stride_(width + 2 * kMargin + kLanes),
        values_(static_cast<std::size_t>(stride_) * (height + 2 * kMargin)) {}

  int width() const { return width_; }
  int height() const { return height_; }
  /// The pixel (0, y). In it x may go from −kMargin to below width + kMargin + kLanes; y from −kMargin to below
  /// height + kMargin.
  float* row(int y) { return values_.data() + start_of(y); }
  const float* row(int y) const { return values_.data() + start_of(y); }

  /// Fills the margin from the picture.
  void mirror();

 private:
  std::size_t start_of(int y) const { return static_cast<std::size_t>(y + kMargin) * stride_ + kMargin; }

  int width_ = 0, height_ = 0, stride_ = 0;
  std::vector<float> values_;
};

/// A plane for each colour.
using ColorPlanes = std::array<Plane, 3>;

/// The plane whose pixel (x, y) is value(x, y).
template <typename Value>
Plane make_plane(int width, int height, const Value& value) {
  Plane plane(width, height);
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < width; ++x) plane.row(y)[x] = value(x, y);
  });
  plane.mirror();
  return plane;
}

/// The planes whose pixel (x, y) is value(c, x, y) in colour c.
template <typename Value>
ColorPlanes make_color_planes(int width, int height, const Value& value) {
  ColorPlanes planes;
  for (int c = 0; c < 3; ++c) planes[c] = make_plane(width, height, [&](int x, int y) { return value(c, x, y); });
  return planes;
}

/// Means over squares of (2·radius + 1)² pixels; radius ≤ Plane::kMargin.
Plane box_blurred(const Plane& plane, int radius);

}  // namespace etendue
