#include "formats/collada/geometry.h"

#include <fmt/format.h>

namespace etendue::collada {

const std::vector<Part>& GeometryLibrary::parts(pugi::xml_node geometry) {
  const auto [place, is_new] = parts_.try_emplace(geometry.internal_object());
  if (is_new) {
    try {
      place->second = read(geometry);
    } catch (const Problem& problem) {
      report_.error(problem);
    }
  }
  return place->second;
}

std::vector<Part> GeometryLibrary::read(pugi::xml_node geometry) {
  if (const pugi::xml_node sphere = cgl_technique(geometry).child("sphere")) return {read_sphere(geometry, sphere)};
  if (const pugi::xml_node mesh = geometry.child("mesh")) return read_mesh(geometry, mesh);
  report_.warning(
      fmt::format("the geometry {} is neither a <mesh> nor a CGL sphere; it is left out", in_quotes(name_of(geometry))),
      document_.locate(geometry));
  return {};
}

Part GeometryLibrary::read_sphere(pugi::xml_node geometry, pugi::xml_node sphere) {
  if (!sphere.child("radius")) throw Problem("<sphere> needs a <radius>", document_.locate(sphere));
  const float radius = read_number(document_, sphere.child("radius"));
  if (!(radius > 0) || !std::isfinite(radius))
    throw Problem(fmt::format("the radius {} of a sphere is not above zero", radius), document_.locate(sphere));
  spheres_.push_back({name_of(geometry), radius, document_.locate(geometry)});
  return {scene::Id<scene::Sphere>{static_cast<std::uint32_t>(spheres_.size() - 1)}, {}};
}

std::vector<Part> GeometryLibrary::read_mesh(pugi::xml_node geometry, pugi::xml_node mesh) {
  std::vector<Part> parts;
  for (const pugi::xml_node primitive : mesh.children()) {
    const std::string_view kind = primitive.name();
    if (kind == "lines" || kind == "linestrips")
      report_.repaired("lines have no surface; they are left out", document_.locate(primitive));
    if (!is_surface_primitive(kind)) continue;
    try {
      scene::Mesh read = primitives_.read(primitive);
      if (read.triangles.empty()) {
        report_.repaired("a part of a mesh has no triangles; it is left out", read.where);
        continue;
      }
      read.name = name_of(geometry);
      meshes_.push_back(std::move(read));
      parts.push_back({scene::Id<scene::Mesh>{static_cast<std::uint32_t>(meshes_.size() - 1)},
                       primitive.attribute("material").value()});
    } catch (const Problem& problem) {
      report_.error(problem);
    }
  }
  return parts;
}

}  // namespace etendue::collada
