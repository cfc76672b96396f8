#include "geometry/local_space.h"

namespace etendue {

LocalSpace::LocalSpace(const Transform& to_world) : origin_(to_world.origin) {
  const Vec3d x(to_world.x), y(to_world.y), z(to_world.z);
  const double scale = 1 / x.dot(y.cross(z));
  x_ = y.cross(z) * scale;
  y_ = z.cross(x) * scale;
  z_ = x.cross(y) * scale;
}

Vec3 LocalSpace::world_normal(const Vec3& local) const {
  // The transposed inverse; its rows are this inverse's columns.
  const Vec3d n = x_ * local.x + y_ * local.y + z_ * local.z;
  return Vec3(n / n.length());
}

}  // namespace etendue
