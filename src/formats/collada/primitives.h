#pragma once

#include <array>
#include <pugixml.hpp>
#include <string_view>
#include <vector>

#include "formats/collada/numbers.h"
#include "formats/collada/sources.h"
#include "formats/mesh/vertices.h"
#include "formats/report.h"
#include "scene/scene.h"

namespace etendue::collada {

/// Whether an element of <mesh> is one that holds triangles.
bool is_surface_primitive(std::string_view element_name);

/// Reads <triangles>, <polylist>, <polygons>, <trifans> and <tristrips> into meshes with one index for each vertex.
class PrimitiveReader {
 public:
  PrimitiveReader(const Document& document, Report& report)
      : document_(document), report_(report), sources_(document) {}

  /// The triangles of `primitive`. Those without area or with a position that is not finite are left out, bad normals
  /// are replaced, and both is reported. Throws Problem if the element contradicts itself.
  scene::Mesh read(pugi::xml_node primitive);

 private:
  static constexpr std::size_t kMostStreams = 256;

  /// Where the corners of the primitive that is read take their data from.
  struct Inputs {
    Accessor positions, normals, uvs;
    bool has_normals = false, has_uvs = false;
    std::size_t position_offset = 0, normal_offset = 0, uv_offset = 0;
    std::size_t stride = 0;                           ///< indices for each corner
    std::array<std::uint64_t, kMostStreams> limit{};  ///< for each of them: indices are below this
  };

  Inputs read_inputs(pugi::xml_node primitive);
  void read_vertices(Inputs& inputs, pugi::xml_node input, std::size_t offset);
  void read_triangles(pugi::xml_node primitive);
  void read_polylist(pugi::xml_node primitive);
  void read_polygons(pugi::xml_node primitive);
  void read_polygon(pugi::xml_node p);
  void read_strips(pugi::xml_node primitive, bool is_fan);

  Corner next_corner(NumberStream& stream) const;
  void next_corners(NumberStream& stream, std::size_t count);
  void add_polygon(SourceLocation where);
  void add_triangle(const Corner& a, const Corner& b, const Corner& c, SourceLocation where);
  void check_polygon_count(pugi::xml_node primitive, std::uint64_t found) const;

  std::vector<Point3> positions() const;
  std::vector<Vec3> normals(SourceLocation where);
  std::vector<Vec2> uvs(SourceLocation where);

  const Document& document_;
  Report& report_;
  SourceLibrary sources_;
  Inputs inputs_;
  VertexTable table_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Corner> corners_;  ///< of the polygon that is read
  std::vector<Point3> corner_points_;
};

}  // namespace etendue::collada
