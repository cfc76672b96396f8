#pragma once

#include <limits>

#include "math/vec.h"

namespace etendue {

/// Axis-aligned box; empty until something is added.
struct Bounds3 {
  Point3 min{std::numeric_limits<float>::infinity()};
  Point3 max{-std::numeric_limits<float>::infinity()};

  void extend(const Point3& p) {
    min = {std::min(min.x, p.x), std::min(min.y, p.y), std::min(min.z, p.z)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y), std::max(max.z, p.z)};
  }
  void extend(const Bounds3& b) {
    if (b.empty()) return;
    extend(b.min);
    extend(b.max);
  }
  bool empty() const { return !(min.x <= max.x); }
  Point3 center() const { return (min + max) * 0.5f; }
  float diagonal() const { return empty() ? 0.0f : length(max - min); }
};

}  // namespace etendue
