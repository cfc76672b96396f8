#pragma once

#include "math/transform.h"

namespace etendue {

/// The inverse of an invertible Transform, in doubles: what floats lose far from the origin stays.
class LocalSpace {
 public:
  LocalSpace() = default;
  explicit LocalSpace(const Transform& to_world);

  Vec3d point(const Vec3d& world) const { return vector(world - origin_); }
  Vec3d vector(const Vec3d& world) const { return {x_.dot(world), y_.dot(world), z_.dot(world)}; }
  /// Image in the world of a normal of the local space, unit, on the same side of the surface.
  Vec3 world_normal(const Vec3& local) const;

 private:
  Vec3d x_{1, 0, 0}, y_{0, 1, 0}, z_{0, 0, 1};  ///< rows
  Vec3d origin_{0, 0, 0};
};

}  // namespace etendue
