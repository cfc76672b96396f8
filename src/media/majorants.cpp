#include "media/majorants.h"

#include <algorithm>

namespace etendue {

Ray within_bounds(const Ray& ray, const Bounds3& box) {
  Ray inside = ray;
  for (int axis = 0; axis < 3; ++axis) {
    const float o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) {
      if (o < box.min[axis] || o > box.max[axis]) inside.t_max = inside.t_min;
      continue;
    }
    const float a = (box.min[axis] - o) / d, b = (box.max[axis] - o) / d;
    inside.t_min = std::max(inside.t_min, std::min(a, b));
    inside.t_max = std::min(inside.t_max, std::max(a, b));
  }
  return inside;
}
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

}  // namespace etendue
