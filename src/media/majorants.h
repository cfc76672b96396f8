#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "math/bounds.h"
#include "math/ray.h"
#include "volumes/volume.h"

namespace etendue {

/// The part of a ray within a box: t_min ≥ t_max if they do not meet.
Ray within_bounds(const Ray& ray, const Bounds3& box);

/// What a volume's values lie between, in each cell of a coarse grid over its bounds: where little is, tracking takes
/// long steps.
class MajorantGrid {
 public:
  MajorantGrid() = default;
  /// Of the volume's values times `scale`, brought into [0, ceiling].
  MajorantGrid(const Volume& volume, float scale, float ceiling);

  bool contains(const Point3& p) const;

  /// Calls visit(t0, t1, range) for the cells that `ray` passes between its t_min and t_max, one after the other
  /// (Amanatides and Woo 1987), until it returns false. Nothing is outside the bounds.
  template <typename Visit>
  void walk(const Ray& ray, const Visit& visit) const;

 private:
  Bounds3 bounds_;
  int resolution_ = 0;
  Vec3 cell_size_{0, 0, 0};
  std::vector<ValueRange> ranges_;
};

template <typename Visit>
void MajorantGrid::walk(const Ray& ray, const Visit& visit) const {
  const Ray inside = within_bounds(ray, bounds_);
  const float begin = inside.t_min, end = inside.t_max;
  if (!(begin < end)) return;
  const Point3 entry = ray.at(begin);
  int cell[3], step[3];
  float next[3], period[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float d = ray.direction[axis];
    const float x = (entry[axis] - bounds_.min[axis]) / cell_size_[axis];
    cell[axis] = std::clamp(static_cast<int>(x), 0, resolution_ - 1);
    step[axis] = d < 0 ? -1 : 1;
    const float wall = bounds_.min[axis] + static_cast<float>(cell[axis] + (d < 0 ? 0 : 1)) * cell_size_[axis];
    next[axis] = d == 0 ? std::numeric_limits<float>::infinity() : (wall - ray.origin[axis]) / d;
    period[axis] = d == 0 ? 0.0f : cell_size_[axis] / std::abs(d);
  }
  float t = begin;
  while (true) {
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    const float leave = std::min(next[axis], end);
    if (leave > t) {
      const std::size_t index = (static_cast<std::size_t>(cell[2]) * resolution_ + cell[1]) * resolution_ + cell[0];
      if (!visit(t, leave, ranges_[index])) return;
      t = leave;
    }
    if (!(next[axis] < end)) return;
    next[axis] += period[axis];
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] >= resolution_) return;
  }
}

}  // namespace etendue
