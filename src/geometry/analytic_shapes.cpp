#include "geometry/analytic_shapes.h"

namespace etendue {
namespace {

/// Image of a local normal on the side it points to, unit; `flip` turns it round.
Vec3 front_normal(const Transform& m, const Vec3& local, bool flip) {
  const Vec3d x(m.x), y(m.y), z(m.z);
  const Vec3d n = y.cross(z) * local.x + z.cross(x) * local.y + x.cross(y) * local.z;
  const bool mirrored = x.dot(y.cross(z)) < 0;
  return Vec3(n / (mirrored != flip ? -n.length() : n.length()));
}

/// Of the ellipse that the unit circle about `center` becomes.
Bounds3 bounds_of_circle(const Transform& m, const Point3& center) {
  const auto half = [](float x, float y) { return std::sqrt(x * x + y * y); };
  const Vec3 h(half(m.x.x, m.y.x), half(m.x.y, m.y.y), half(m.x.z, m.y.z));
  return {center - h, center + h};
}

}  // namespace

ShapePoint point_at(const DiskShape& disk, float a, float b) {
  const Transform& m = disk.to_world;
  return {m.point({a, b, 0}), front_normal(m, {0, 0, 1}, disk.flip_normals), m.x, m.y};
}

ShapePoint point_at(const CylinderShape& cylinder, float a, float b) {
  const Transform& m = cylinder.to_world;
  const float angle = 2 * kPi * a, c = std::cos(angle), s = std::sin(angle);
  return {m.point({c, s, b}), front_normal(m, {c, s, 0}, cylinder.flip_normals), m.vector({-s, c, 0}) * (2 * kPi), m.z};
}

Bounds3 bounds_of(const DiskShape& disk) {
  return bounds_of_circle(disk.to_world, disk.to_world.origin);
}

Bounds3 bounds_of(const CylinderShape& cylinder) {
  const Transform& m = cylinder.to_world;
  Bounds3 box = bounds_of_circle(m, m.origin);
  box.extend(bounds_of_circle(m, m.origin + m.z));
  return box;
}

float area_of(const DiskShape& disk) {
  return kPi * length(cross(disk.to_world.x, disk.to_world.y));
}

float area_of(const CylinderShape& cylinder) {
  // The trapezoidal rule converges exponentially on periodic functions (Trefethen and Weideman 2014).
  constexpr int kSteps = 256;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const ShapePoint point = point_at(cylinder, static_cast<float>(i) / kSteps, 0);
    sum += length(cross(point.dp_da, point.dp_db));
  }
  return static_cast<float>(sum / kSteps);
}

}  // namespace etendue
