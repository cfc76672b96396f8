#include "formats/collada/primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "formats/mesh/polygons.h"

namespace etendue::collada {
namespace {

constexpr std::uint64_t kNotGiven = std::numeric_limits<std::uint64_t>::max();

std::size_t read_offset(const Document& document, pugi::xml_node input, std::size_t limit) {
  const std::uint64_t offset = read_count(document, input, "offset", kNotGiven);
  if (offset == kNotGiven) throw Problem("<input> has no offset", document.locate(input));
  if (offset >= limit)
    throw Problem(fmt::format("the offset {} of <input> is too large: {} is the most", offset, limit - 1),
                  document.locate(input.attribute("offset").value()));
  return offset;
}

}  // namespace

bool is_surface_primitive(std::string_view name) {
  return name == "triangles" || name == "polylist" || name == "polygons" || name == "trifans" || name == "tristrips";
}

scene::Mesh PrimitiveReader::read(pugi::xml_node primitive) {
  inputs_ = read_inputs(primitive);
  table_.restart(inputs_.positions.count());
  triangles_.clear();

  const std::string_view kind = primitive.name();
  if (kind == "triangles") read_triangles(primitive);
  if (kind == "polylist") read_polylist(primitive);
  if (kind == "polygons") read_polygons(primitive);
  if (kind == "trifans" || kind == "tristrips") read_strips(primitive, kind == "trifans");

  scene::Mesh mesh;
  mesh.where = document_.locate(primitive);
  mesh.positions = positions();
  mesh.normals = normals(mesh.where);
  mesh.uvs = uvs(mesh.where);
  mesh.triangles = std::move(triangles_);
  return mesh;
}

PrimitiveReader::Inputs PrimitiveReader::read_inputs(pugi::xml_node primitive) {
  Inputs inputs;
  inputs.limit.fill(std::uint64_t{1} << 32);
  bool has_vertices = false;
  std::uint64_t lowest_uv_set = kNotGiven;
  pugi::xml_node normal_input, uv_input;
  for (const pugi::xml_node input : primitive.children("input")) {
    const std::string_view semantic = input.attribute("semantic").value();
    const std::size_t offset = read_offset(document_, input, kMostStreams);
    inputs.stride = std::max(inputs.stride, offset + 1);
    if (semantic == "VERTEX") {
      read_vertices(inputs, input, offset);
      has_vertices = true;
    } else if (semantic == "NORMAL") {
      normal_input = input;
    } else if (semantic == "TEXCOORD") {
      const std::uint64_t set = read_count(document_, input, "set", 0);
      if (set < lowest_uv_set) uv_input = input;
      lowest_uv_set = std::min(set, lowest_uv_set);
    }
  }
  if (!has_vertices)
    throw Problem(fmt::format("<{}> has no <input semantic=\"VERTEX\">", primitive.name()),
                  document_.locate(primitive));

  const auto limit_to = [&](std::size_t offset, const Accessor& accessor) {
    inputs.limit[offset] = std::min<std::uint64_t>(inputs.limit[offset], accessor.count());
  };
  if (normal_input) {
    inputs.normals = sources_.read(document_.referenced(normal_input, "source", "source"), 3);
    inputs.normal_offset = read_offset(document_, normal_input, kMostStreams);
    inputs.has_normals = true;
  }
  if (uv_input) {
    inputs.uvs = sources_.read(document_.referenced(uv_input, "source", "source"), 2);
    inputs.uv_offset = read_offset(document_, uv_input, kMostStreams);
    inputs.has_uvs = true;
  }
  limit_to(inputs.position_offset, inputs.positions);
  if (inputs.has_normals) limit_to(inputs.normal_offset, inputs.normals);
  if (inputs.has_uvs) limit_to(inputs.uv_offset, inputs.uvs);
  return inputs;
}

/// The inputs inside <vertices>, which all take the index of the VERTEX input.
void PrimitiveReader::read_vertices(Inputs& inputs, pugi::xml_node input, std::size_t offset) {
  const pugi::xml_node vertices = document_.referenced(input, "source", "vertices");
  inputs.position_offset = offset;
  bool has_positions = false;
  for (const pugi::xml_node shared : vertices.children("input")) {
    const std::string_view semantic = shared.attribute("semantic").value();
    if (semantic == "POSITION") {
      inputs.positions = sources_.read(document_.referenced(shared, "source", "source"), 3);
      has_positions = true;
    } else if (semantic == "NORMAL") {
      inputs.normals = sources_.read(document_.referenced(shared, "source", "source"), 3);
      inputs.normal_offset = offset;
      inputs.has_normals = true;
    } else if (semantic == "TEXCOORD" && !inputs.has_uvs) {
      inputs.uvs = sources_.read(document_.referenced(shared, "source", "source"), 2);
      inputs.uv_offset = offset;
      inputs.has_uvs = true;
    }
  }
  if (!has_positions) throw Problem("<vertices> has no <input semantic=\"POSITION\">", document_.locate(vertices));
}

Corner PrimitiveReader::next_corner(NumberStream& stream) const {
  std::array<std::uint32_t, kMostStreams> index;
  for (std::size_t i = 0; i < inputs_.stride; ++i) {
    const std::int64_t value = stream.next_integer();
    if (value < 0 || static_cast<std::uint64_t>(value) >= inputs_.limit[i])
      throw Problem(
          fmt::format("the index {} is out of range: there are {} vectors, counted from 0", value, inputs_.limit[i]),
          stream.where());
    index[i] = static_cast<std::uint32_t>(value);
  }
  return {index[inputs_.position_offset], inputs_.has_normals ? index[inputs_.normal_offset] : kNone,
          inputs_.has_uvs ? index[inputs_.uv_offset] : kNone};
}

void PrimitiveReader::next_corners(NumberStream& stream, std::size_t count) {
  corners_.clear();
  for (std::size_t i = 0; i < count; ++i) corners_.push_back(next_corner(stream));
}

void PrimitiveReader::check_polygon_count(pugi::xml_node primitive, std::uint64_t found) const {
  const std::uint64_t claimed = read_count(document_, primitive, "count", found);
  if (claimed != found)
    throw Problem(fmt::format("<{}> says count=\"{}\", but holds {}", primitive.name(), claimed, found),
                  document_.locate(primitive));
}

void PrimitiveReader::read_triangles(pugi::xml_node primitive) {
  std::uint64_t found = 0;
  const std::uint64_t claimed = read_count(document_, primitive, "count", 0);
  for (const pugi::xml_node p : primitive.children("p")) {
    NumberStream stream(document_, p);
    triangles_.reserve(std::min<std::uint64_t>(claimed, stream.most_left() / (3 * inputs_.stride)));
    for (; !stream.at_end(); ++found) {
      next_corners(stream, 3);
      add_triangle(corners_[0], corners_[1], corners_[2], stream.where());
    }
  }
  check_polygon_count(primitive, found);
}

void PrimitiveReader::read_polylist(pugi::xml_node primitive) {
  const pugi::xml_node vcount = primitive.child("vcount"), p = primitive.child("p");
  std::vector<std::uint32_t> sizes;
  std::uint64_t corner_count = 0;
  NumberStream counts(document_, vcount);
  for (sizes.reserve(counts.most_left()); !counts.at_end();) {
    const std::int64_t size = counts.next_integer();
    if (size < 0 || size >= kNone) throw Problem(fmt::format("a polygon cannot have {} corners", size), counts.where());
    sizes.push_back(static_cast<std::uint32_t>(size));
    corner_count += sizes.back();
  }
  check_polygon_count(primitive, sizes.size());

  NumberStream stream(document_, p);
  const std::size_t most_corners = stream.most_left() / inputs_.stride;
  if (corner_count > most_corners)
    throw Problem(fmt::format("<vcount> adds up to {} corners, but <p> is too short for them", corner_count),
                  document_.locate(vcount));
  triangles_.reserve(corner_count > 2 * sizes.size() ? corner_count - 2 * sizes.size() : 0);
  for (const std::uint32_t size : sizes) {
    next_corners(stream, size);
    add_polygon(stream.where());
  }
  if (!stream.at_end())
    throw Problem(fmt::format("<vcount> adds up to {} corners, but <p> holds more", corner_count),
                  document_.locate(vcount));
}

void PrimitiveReader::read_polygons(pugi::xml_node primitive) {
  std::uint64_t found = 0;
  for (const pugi::xml_node child : primitive.children()) {
    const std::string_view name = child.name();
    if (name == "p") read_polygon(child);
    if (name == "ph") {
      report_.repaired("a polygon has holes (<ph>); they are filled", document_.locate(child));
      read_polygon(child.child("p"));
    }
    if (name == "p" || name == "ph") ++found;
  }
  check_polygon_count(primitive, found);
}

void PrimitiveReader::read_polygon(pugi::xml_node p) {
  NumberStream stream(document_, p);
  corners_.clear();
  while (!stream.at_end()) corners_.push_back(next_corner(stream));
  add_polygon(document_.locate(p));
}

void PrimitiveReader::read_strips(pugi::xml_node primitive, bool is_fan) {
  std::uint64_t found = 0;
  for (const pugi::xml_node p : primitive.children("p")) {
    NumberStream stream(document_, p);
    corners_.clear();
    while (!stream.at_end()) corners_.push_back(next_corner(stream));
    for (std::size_t i = 2; i < corners_.size(); ++i) {
      const bool is_flipped = !is_fan && i % 2 == 1;
      const Corner& first = corners_[is_fan ? 0 : i - 2];
      const Corner& second = corners_[i - 1];
      add_triangle(is_flipped ? second : first, is_flipped ? first : second, corners_[i], document_.locate(p));
    }
    ++found;
  }
  check_polygon_count(primitive, found);
}

void PrimitiveReader::add_polygon(SourceLocation where) {
  if (corners_.size() == 3) return add_triangle(corners_[0], corners_[1], corners_[2], where);
  if (corners_.size() < 3) return report_.repaired("a polygon has fewer than three corners; it is left out", where);
  corner_points_.clear();
  for (const Corner& corner : corners_) corner_points_.push_back(inputs_.positions.vec3(corner.position));
  const Triangulation cut = triangulate(corner_points_);
  if (!cut.is_simple)
    report_.repaired("a polygon's outline crosses itself or has too many corners; its area may be wrong", where);
  for (const auto& [a, b, c] : cut.triangles) add_triangle(corners_[a], corners_[b], corners_[c], where);
}

void PrimitiveReader::add_triangle(const Corner& a, const Corner& b, const Corner& c, SourceLocation where) {
  const Point3 pa = inputs_.positions.vec3(a.position), pb = inputs_.positions.vec3(b.position),
               pc = inputs_.positions.vec3(c.position);
  if (!is_finite(pa) || !is_finite(pb) || !is_finite(pc))
    return report_.repaired("a triangle has a position that is not finite; it is left out", where);
  if (has_no_area(pa, pb, pc)) return report_.repaired("a triangle has no area; it is left out", where);
  triangles_.push_back({table_.vertex(a), table_.vertex(b), table_.vertex(c)});
}

std::vector<Point3> PrimitiveReader::positions() const {
  std::vector<Point3> result;
  result.reserve(table_.vertices().size());
  for (const Corner& vertex : table_.vertices()) result.push_back(inputs_.positions.vec3(vertex.position));
  return result;
}

/// Unit normals. One that has no direction becomes that of the triangles around its vertex, weighted by their area.
std::vector<Vec3> PrimitiveReader::normals(SourceLocation where) {
  std::vector<Vec3> result;
  if (!inputs_.has_normals) return result;
  const std::span<const Corner> vertices = table_.vertices();
  result.reserve(vertices.size());
  std::uint64_t bad = 0;
  for (const Corner& vertex : vertices) {
    result.push_back(unit_or_zero(inputs_.normals.vec3(vertex.normal)));
    bad += result.back() == Vec3(0) ? 1 : 0;
  }
  if (bad == 0) return result;

  report_.repaired("a normal is zero or not finite; the triangle's own is used", where, bad);
  std::vector<Vec3> geometric(vertices.size(), Vec3(0));
  for (const auto& triangle : triangles_) {
    const Point3 p = inputs_.positions.vec3(vertices[triangle[0]].position);
    const Vec3 area = cross(inputs_.positions.vec3(vertices[triangle[1]].position) - p,
                            inputs_.positions.vec3(vertices[triangle[2]].position) - p);
    for (const std::uint32_t v : triangle) geometric[v] += area;
  }
  for (std::size_t v = 0; v < result.size(); ++v)
    if (result[v] == Vec3(0)) {
      const Vec3 normal = unit_or_zero(geometric[v]);
      result[v] = normal == Vec3(0) ? Vec3(0, 1, 0) : normal;
    }
  return result;
}

std::vector<Vec2> PrimitiveReader::uvs(SourceLocation where) {
  std::vector<Vec2> result;
  if (!inputs_.has_uvs) return result;
  result.reserve(table_.vertices().size());
  std::uint64_t bad = 0;
  for (const Corner& vertex : table_.vertices()) {
    const Vec2 uv = inputs_.uvs.vec2(vertex.uv);
    const bool is_good = std::isfinite(uv.x) && std::isfinite(uv.y);
    bad += is_good ? 0 : 1;
    result.push_back(is_good ? uv : Vec2(0));
  }
  report_.repaired("a texture coordinate is not finite; 0 0 is used", where, bad);
  return result;
}

}  // namespace etendue::collada
