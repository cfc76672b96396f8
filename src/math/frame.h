#pragma once

#include "math/vec.h"

namespace etendue {

/// Orthonormal, right-handed frame whose z axis is `n`.
struct Frame {
  Vec3 s, t, n;

  /// From a unit normal, without branches at the poles (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
  static Frame from_normal(const Vec3& n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }

  /// From a unit normal and a direction that s follows as far as it is perpendicular; any s if it is not at all.
  static Frame from_normal_and_tangent(const Vec3& n, const Vec3& tangent) {
    const Vec3 level = tangent - n * dot(n, tangent);
    const float l2 = length_squared(level);
    if (!(l2 > 0) || !std::isfinite(l2)) return from_normal(n);
    const Vec3 s = level * (1 / std::sqrt(l2));
    return {s, cross(n, s), n};
  }

  Vec3 to_local(const Vec3& v) const { return {dot(v, s), dot(v, t), dot(v, n)}; }
  Vec3 to_world(const Vec3& v) const { return s * v.x + t * v.y + n * v.z; }
};

}  // namespace etendue
