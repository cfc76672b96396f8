#pragma once

#include "math/vec.h"

namespace etendue {

/// Affine map p ↦ x·p.x + y·p.y + z·p.z + origin: the columns are the images of the unit vectors and of the origin.
struct Transform {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  Point3 origin{0, 0, 0};

  static Transform translation(const Vec3& t) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, t}; }
  static Transform scaling(const Vec3& s) { return {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {0, 0, 0}}; }
  /// Rotation by `angle` radians about `axis` (any length but zero), counter-clockwise seen from the axis' tip.
  static Transform rotation(const Vec3& axis, float angle);
  /// Frame of an observer at `eye` who looks along −z towards `target`, with `up` in the upper half of its yz plane.
  static Transform look_at(const Point3& eye, const Point3& target, const Vec3& up);

  Point3 point(const Point3& p) const { return x * p.x + y * p.y + z * p.z + origin; }
  Vec3 vector(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  /// Image of a surface normal, by the cofactor matrix: right for any invertible map, not normalised; mirrored maps
  /// flip it.
  Vec3 normal(const Vec3& n) const { return cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z; }
  float determinant() const { return dot(x, cross(y, z)); }
  /// Not finite if the determinant is zero.
  Transform inverse() const;

  /// First `b`, then `a`.
  friend Transform operator*(const Transform& a, const Transform& b) {
    return {a.vector(b.x), a.vector(b.y), a.vector(b.z), a.point(b.origin)};
  }
};

}  // namespace etendue
