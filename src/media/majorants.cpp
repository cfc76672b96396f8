#include "media/majorants.h"

#include <algorithm>

namespace etendue {
namespace {

/// Cells along each axis: more are left sooner than they save steps.
constexpr int kResolution = 16;

/// NaN becomes `low`.
float clamped(float x, float low, float high) {
  return x > low ? std::min(x, high) : low;
}

}  // namespace

MajorantGrid::MajorantGrid(const Volume& volume, float scale, float ceiling) : bounds_(volume.bounds()) {
  const auto range_in = [&](const Bounds3& box) {
    const ValueRange range = volume.range(box);
    return ValueRange{clamped(range.min * scale, 0, ceiling), clamped(range.max * scale, 0, ceiling)};
  };
  const ValueRange all = range_in(bounds_);
  resolution_ = all.min < all.max ? kResolution : 1;
  cell_size_ = (bounds_.max - bounds_.min) / static_cast<float>(resolution_);
  for (int z = 0; z < resolution_; ++z)
    for (int y = 0; y < resolution_; ++y)
      for (int x = 0; x < resolution_; ++x) {
        const Vec3 cell(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
        ranges_.push_back(range_in({bounds_.min + cell * cell_size_, bounds_.min + (cell + Vec3(1)) * cell_size_}));
      }
}

bool MajorantGrid::contains(const Point3& p) const {
  for (int axis = 0; axis < 3; ++axis)
    if (!(p[axis] >= bounds_.min[axis] && p[axis] <= bounds_.max[axis])) return false;
  return true;
}

MajorantGrid::Interval MajorantGrid::clip(const Ray& ray) const {
  Interval inside{ray.t_min, ray.t_max};
  for (int axis = 0; axis < 3; ++axis) {
    const float o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) {
      if (o < bounds_.min[axis] || o > bounds_.max[axis]) return {0, 0};
      continue;
    }
    const float a = (bounds_.min[axis] - o) / d, b = (bounds_.max[axis] - o) / d;
    inside.begin = std::max(inside.begin, std::min(a, b));
    inside.end = std::min(inside.end, std::max(a, b));
  }
  return inside;
}

}  // namespace etendue
