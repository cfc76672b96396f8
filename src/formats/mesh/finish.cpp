#include "formats/mesh/finish.h"

#include <fmt/format.h>

#include <cmath>

#include "formats/mesh/polygons.h"

namespace etendue {
namespace {

/// Collects repairs under "FILE: what".
class Repairs {
 public:
  Repairs(const std::string& name, Diagnostics& diagnostics) : name_(name), diagnostics_(diagnostics) {}
  void add(std::string_view what, std::uint64_t times) {
    if (times > 0) diagnostics_.repaired(fmt::format("{}: {}", name_, what), {}, times);
  }

 private:
  const std::string& name_;
  Diagnostics& diagnostics_;
};

void remove_face(scene::Mesh& mesh, std::size_t kept, std::size_t face) {
  mesh.triangles[kept] = mesh.triangles[face];
  for (scene::MeshAttribute& attribute : mesh.attributes)
    if (attribute.per_face) {
      const auto channels = static_cast<std::size_t>(attribute.channels);
      for (std::size_t c = 0; c < channels; ++c)
        attribute.values[kept * channels + c] = attribute.values[face * channels + c];
    }
}

/// Keeps the triangles that have an area, in order, and their attributes with them.
void remove_bad_triangles(scene::Mesh& mesh, Repairs& repairs) {
  std::size_t kept = 0;
  std::uint64_t not_finite = 0;
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
    const auto& [a, b, c] = mesh.triangles[face];
    const Point3 &pa = mesh.positions[a], &pb = mesh.positions[b], &pc = mesh.positions[c];
    if (!is_finite(pa) || !is_finite(pb) || !is_finite(pc)) {
      ++not_finite;
    } else if (!has_no_area(pa, pb, pc)) {
      if (kept != face) remove_face(mesh, kept, face);
      ++kept;
    }
  }
  repairs.add("a triangle has a position that is not finite; it is left out", not_finite);
  repairs.add("a triangle has no area; it is left out", mesh.triangles.size() - kept - not_finite);
  mesh.triangles.resize(kept);
  for (scene::MeshAttribute& attribute : mesh.attributes)
    if (attribute.per_face) attribute.values.resize(kept * static_cast<std::size_t>(attribute.channels));
}

/// Each group's mean normal: those of the triangles around it, weighted by their angles there (Thürmer & Wüthrich
/// 1998).
std::vector<Vec3> smooth_normals(const scene::Mesh& mesh, const std::vector<std::uint32_t>& group) {
  const auto group_of = [&](std::uint32_t vertex) { return group.empty() ? vertex : group[vertex]; };
  std::uint32_t group_count = 0;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) group_count = std::max(group_count, group_of(v) + 1);
  std::vector<Vec3d> sums(group_count, Vec3d(0));
  for (const auto& triangle : mesh.triangles)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Vec3d p(mesh.positions[triangle[corner]]);
      const Vec3d next = Vec3d(mesh.positions[triangle[(corner + 1) % 3]]) - p;
      const Vec3d previous = Vec3d(mesh.positions[triangle[(corner + 2) % 3]]) - p;
      const Vec3d normal = next.cross(previous);
      const double sine = std::sqrt(normal.dot(normal));
      if (sine > 0) sums[group_of(triangle[corner])] += normal * (std::atan2(sine, next.dot(previous)) / sine);
    }
  std::vector<Vec3> normals;
  normals.reserve(mesh.positions.size());
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d& sum = sums[group_of(v)];
    const double length = std::sqrt(sum.dot(sum));
    normals.push_back(length > 0 ? Vec3(sum / length) : Vec3(0, 1, 0));
  }
  return normals;
}

void mend_normals(scene::Mesh& mesh, const std::vector<std::uint32_t>& group, Repairs& repairs) {
  if (mesh.normals.empty()) {
    mesh.normals = smooth_normals(mesh, group);
    return;
  }
  std::uint64_t bad = 0;
  for (Vec3& normal : mesh.normals) {
    normal = unit_or_zero(normal);
    bad += normal == Vec3(0) ? 1 : 0;
  }
  if (bad == 0) return;
  repairs.add("a normal is missing, zero or not finite; a smooth one is used", bad);
  const std::vector<Vec3> smooth = smooth_normals(mesh, group);
  for (std::size_t v = 0; v < mesh.normals.size(); ++v)
    if (mesh.normals[v] == Vec3(0)) mesh.normals[v] = smooth[v];
}

void mend_uvs(scene::Mesh& mesh, Repairs& repairs) {
  std::uint64_t bad = 0;
  for (Vec2& uv : mesh.uvs)
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      uv = Vec2(0);
      ++bad;
    }
  repairs.add("a texture coordinate is not finite; 0 0 is used", bad);
}

void mend_attributes(scene::Mesh& mesh, Repairs& repairs) {
  std::uint64_t bad = 0;
  for (scene::MeshAttribute& attribute : mesh.attributes)
    for (float& value : attribute.values)
      if (!std::isfinite(value)) {
        value = 0;
        ++bad;
      }
  repairs.add("a vertex or face attribute is not finite; 0 is used", bad);
}

}  // namespace

scene::Mesh finish_mesh(scene::Mesh mesh, const std::vector<std::uint32_t>& smoothing_group,
                        const MeshFileOptions& options, const std::string& name, Diagnostics& diagnostics) {
  Repairs repairs(name, diagnostics);
  remove_bad_triangles(mesh, repairs);
  mend_uvs(mesh, repairs);
  mend_attributes(mesh, repairs);
  if (options.face_normals)
    mesh.normals.clear();
  else
    mend_normals(mesh, smoothing_group, repairs);
  if (options.flip_tex_coords)
    for (Vec2& uv : mesh.uvs) uv.y = 1 - uv.y;
  if (options.flip_normals) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[2]);
    for (Vec3& normal : mesh.normals) normal = -normal;
  }
  if (mesh.triangles.empty()) diagnostics.warning(fmt::format("{}: there is no triangle in this file", name));
  return mesh;
}

}  // namespace etendue
