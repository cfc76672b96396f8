#include "formats/mesh/write_ply.h"

#include <fmt/format.h>

#include <utility>

#include "formats/file_bytes.h"

namespace etendue {
namespace {

std::string_view without_prefix(std::string_view name) {
  for (const std::string_view prefix : {"vertex_", "face_"})
    if (name.starts_with(prefix)) return name.substr(prefix.size());
  return name;
}

/// NAME_0, or NAME_0 NAME_1 NAME_2.
std::string declarations(const scene::Mesh& mesh, bool per_face) {
  std::string text;
  for (const scene::MeshAttribute& attribute : mesh.attributes)
    for (int c = 0; attribute.per_face == per_face && c < attribute.channels; ++c)
      text += fmt::format("property float {}_{}\n", without_prefix(attribute.name), c);
  return text;
}

std::string header(const scene::Mesh& mesh) {
  std::string text = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.size());
  text += "property float x\nproperty float y\nproperty float z\n";
  if (!mesh.normals.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.uvs.empty()) text += "property float u\nproperty float v\n";
  text += declarations(mesh, false);
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", mesh.triangles.size());
  return text + declarations(mesh, true) + "end_header\n";
}

void add_attributes(std::string& bytes, const scene::Mesh& mesh, bool per_face, std::size_t index) {
  for (const scene::MeshAttribute& attribute : mesh.attributes) {
    const auto channels = static_cast<std::size_t>(attribute.channels);
    for (std::size_t c = 0; attribute.per_face == per_face && c < channels; ++c)
      store_number(bytes, attribute.values[index * channels + c]);
  }
}

bool is_turned_away(const scene::Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  if (mesh.normals.empty()) return false;
  const Point3& origin = mesh.positions[t[0]];
  const Vec3 front = cross(mesh.positions[t[1]] - origin, mesh.positions[t[2]] - origin);
  return dot(front, mesh.normals[t[0]]) + dot(front, mesh.normals[t[1]]) + dot(front, mesh.normals[t[2]]) < 0;
}

}  // namespace

std::string ply_bytes(const scene::Mesh& mesh) {
  std::string bytes = header(mesh);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    for (int i = 0; i < 3; ++i) store_number(bytes, mesh.positions[v][i]);
    for (int i = 0; i < 3 && !mesh.normals.empty(); ++i) store_number(bytes, mesh.normals[v][i]);
    for (int i = 0; i < 2 && !mesh.uvs.empty(); ++i) store_number(bytes, mesh.uvs[v][i]);
    add_attributes(bytes, mesh, false, v);
  }
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    auto triangle = mesh.triangles[f];
    if (is_turned_away(mesh, triangle)) std::swap(triangle[1], triangle[2]);
    store_number(bytes, std::uint8_t{3});
    for (const std::uint32_t corner : triangle) store_number(bytes, static_cast<std::int32_t>(corner));
    add_attributes(bytes, mesh, true, f);
  }
  return bytes;
}

}  // namespace etendue
