#include "formats/mitsuba/primitives.h"

namespace etendue::mitsuba {
namespace {

/// Adds the square `center` ± u ± v, its front the side of `normal`; texture coordinates from 0 to 1 along u and v.
void add_square(scene::Mesh& mesh, const Point3& center, const Vec3& u, const Vec3& v, const Vec3& normal) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec2& uv : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
    mesh.positions.push_back(center + u * (2 * uv.x - 1) + v * (2 * uv.y - 1));
    mesh.normals.push_back(normal);
    mesh.uvs.push_back(uv);
  }
  const bool clockwise = dot(cross(u, v), normal) < 0;
  for (const auto& [second, third] : {std::pair{1u, 2u}, std::pair{2u, 3u}})
    mesh.triangles.push_back({first, first + (clockwise ? third : second), first + (clockwise ? second : third)});
}

}  // namespace

scene::Mesh rectangle(bool flip_normals) {
  scene::Mesh mesh;
  mesh.name = "rectangle";
  add_square(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, flip_normals ? -1.0f : 1.0f});
  return mesh;
}

scene::Mesh cube(bool flip_normals) {
  struct Side {
    Vec3 u, v;
  };
  // Seen from outside, all sides have their texture coordinates clockwise.
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const Side sides[] = {{z, x}, {-x, -z}, {y, -z}, {y, x}, {y, z}, {-y, x}};
  scene::Mesh mesh;
  mesh.name = "cube";
  for (const Side& side : sides) {
    const Vec3 outside = cross(side.v, side.u);
    add_square(mesh, outside, side.u, side.v, flip_normals ? -outside : outside);
  }
  return mesh;
}

}  // namespace etendue::mitsuba
