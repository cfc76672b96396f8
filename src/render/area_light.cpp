#include "render/area_light.h"

#include <optional>

namespace etendue {
namespace {

/// Two triangles that are the halves of one rectangle with the same front: that rectangle.
std::optional<Rectangle> as_rectangle(const TriangleMesh& mesh) {
  if (mesh.triangles.size() != 2) return std::nullopt;
  const auto corner = [&](int triangle, int i) { return mesh.positions[mesh.triangles[triangle][i % 3]]; };
  const auto stands_in = [&](int triangle, const Point3& p) {
    for (int i = 0; i < 3; ++i)
      if (corner(triangle, i) == p) return true;
    return false;
  };
  for (int i = 0; i < 3; ++i) {
    const Point3 c = corner(0, i), next = corner(0, i + 1), previous = corner(0, i + 2);
    if (stands_in(1, c) || !stands_in(1, next) || !stands_in(1, previous)) continue;
    const Vec3 x = next - c, y = previous - c;
    const float size2 = std::max(length_squared(x), length_squared(y));
    const Vec3 front = cross(corner(1, 1) - corner(1, 0), corner(1, 2) - corner(1, 0));
    for (int j = 0; j < 3; ++j) {
      const Point3 opposite = corner(1, j);
      if (stands_in(0, opposite)) continue;
      const bool closes = length_squared(c + x + y - opposite) < 1e-10f * size2;
      const bool right_angle = std::abs(dot(x, y)) < 1e-4f * std::sqrt(length_squared(x) * length_squared(y));
      if (closes && right_angle && dot(front, cross(x, y)) > 0) return Rectangle(c, x, y);
    }
  }
  return std::nullopt;
}

}  // namespace

Light make_area_light(const TriangleMesh& mesh, const Spectrum& emitted) {
  if (const std::optional<Rectangle> rectangle = as_rectangle(mesh)) return RectangleLight{*rectangle, emitted};
  std::vector<MeshLight::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Point3 &p0 = mesh.positions[a], &p1 = mesh.positions[b], &p2 = mesh.positions[c];
    const Vec3 n = cross(p1 - p0, p2 - p0);
    const float l = length(n);
    triangles.push_back({p0, p1, p2, n * (1 / l), 0.5f * l});
  }
  return MeshLight(std::move(triangles), emitted);
}

}  // namespace etendue
