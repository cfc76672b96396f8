#pragma once

#include <pugixml.hpp>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "formats/collada/primitives.h"
#include "scene/scene.h"

namespace etendue::collada {

/// A shape of a geometry, and the symbol under which its material is bound where the geometry is instanced.
struct Part {
  std::variant<scene::Id<scene::Mesh>, scene::Id<scene::Sphere>> shape;
  std::string material_symbol;  ///< empty: none
};

/// The document's geometries, each read when it is first instanced.
class GeometryLibrary {
 public:
  GeometryLibrary(const Document& document, Report& report)
      : document_(document), report_(report), primitives_(document, report) {}

  /// The parts of a <geometry>: one for each primitive element of its mesh, or the sphere of its CGL technique. What is
  /// wrong with it is reported, once, and those parts are missing.
  const std::vector<Part>& parts(pugi::xml_node geometry);

  /// All shapes that were read; leaves none behind.
  std::vector<scene::Mesh> take_meshes() { return std::move(meshes_); }
  std::vector<scene::Sphere> take_spheres() { return std::move(spheres_); }

 private:
  std::vector<Part> read(pugi::xml_node geometry);
  Part read_sphere(pugi::xml_node geometry, pugi::xml_node sphere);
  std::vector<Part> read_mesh(pugi::xml_node geometry, pugi::xml_node mesh);

  const Document& document_;
  Report& report_;
  PrimitiveReader primitives_;
  std::vector<scene::Mesh> meshes_;
  std::vector<scene::Sphere> spheres_;
  std::unordered_map<const void*, std::vector<Part>> parts_;
};

}  // namespace etendue::collada
