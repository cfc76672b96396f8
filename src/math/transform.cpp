#include "math/transform.h"

namespace etendue {

Transform Transform::rotation(const Vec3& axis, float angle) {
  const Vec3 a = normalize(axis);
  const float s = std::sin(angle), c = std::cos(angle), k = 1 - c;
  return {{c + a.x * a.x * k, a.y * a.x * k + a.z * s, a.z * a.x * k - a.y * s},
          {a.x * a.y * k - a.z * s, c + a.y * a.y * k, a.z * a.y * k + a.x * s},
          {a.x * a.z * k + a.y * s, a.y * a.z * k - a.x * s, c + a.z * a.z * k},
          {0, 0, 0}};
}

Transform Transform::look_at(const Point3& eye, const Point3& target, const Vec3& up) {
  const Vec3 back = normalize(eye - target);
  Vec3 right = cross(up, back);
  if (length_squared(right) < 1e-12f * length_squared(up))  // looking along `up`: any right hand will do
    right = cross(std::abs(back.x) < 0.9f ? Vec3(1, 0, 0) : Vec3(0, 1, 0), back);
  right = normalize(right);
  return {right, cross(back, right), back, eye};
}

Transform Transform::inverse() const {
  const float inv_det = 1.0f / determinant();
  const Vec3 r0 = cross(y, z) * inv_det, r1 = cross(z, x) * inv_det, r2 = cross(x, y) * inv_det;
  Transform inv{{r0.x, r1.x, r2.x}, {r0.y, r1.y, r2.y}, {r0.z, r1.z, r2.z}, {0, 0, 0}};
  inv.origin = -inv.vector(origin);
  return inv;
}

}  // namespace etendue
