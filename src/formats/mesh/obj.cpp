#include "formats/mesh/obj.h"

#include <fmt/format.h>

#include "formats/file_bytes.h"
#include "formats/mesh/finish.h"
#include "formats/mesh/polygons.h"
#include "formats/mesh/vertices.h"
#include "formats/text_cursor.h"

namespace etendue {
namespace {

/// Reads line by line; faces may use what stands before them.
class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& name, Diagnostics& diagnostics)
      : cursor_(text, name), name_(name), diagnostics_(diagnostics) {}

  void read() {
    for (; cursor_.left() > 0; cursor_.to_next_line())
      if (cursor_.to_word()) read_statement(cursor_.word());
    constexpr std::string_view kFewCorners = "a face has fewer than three corners; it is left out";
    constexpr std::string_view kNotSimple =
        "a face's outline crosses itself or has too many corners; its area may be wrong";
    if (few_corners_ > 0) diagnostics_.repaired(fmt::format("{}: {}", name_, kFewCorners), {}, few_corners_);
    if (not_simple_ > 0) diagnostics_.repaired(fmt::format("{}: {}", name_, kNotSimple), {}, not_simple_);
  }

  /// One vertex for each different corner; `positions_used` gets the index of each vertex's position.
  struct Indexed {
    scene::Mesh mesh;
    std::vector<std::uint32_t> position_of_vertex;
  };
  Indexed indexed() const {
    VertexTable table;
    table.restart(positions_.size());
    Indexed result;
    scene::Mesh& mesh = result.mesh;
    mesh.triangles.reserve(triangle_corners_.size() / 3);
    for (std::size_t i = 0; i < triangle_corners_.size(); i += 3)
      mesh.triangles.push_back({table.vertex(triangle_corners_[i]), table.vertex(triangle_corners_[i + 1]),
                                table.vertex(triangle_corners_[i + 2])});
    const std::size_t count = table.vertices().size();
    mesh.positions.reserve(count);
    result.position_of_vertex.reserve(count);
    if (has_normals_) mesh.normals.reserve(count);
    if (has_uvs_) mesh.uvs.reserve(count);
    for (const Corner& vertex : table.vertices()) {
      mesh.positions.push_back(positions_[vertex.position]);
      result.position_of_vertex.push_back(vertex.position);
      if (has_normals_) mesh.normals.push_back(vertex.normal == kNone ? Vec3(0) : normals_[vertex.normal]);
      if (has_uvs_) mesh.uvs.push_back(vertex.uv == kNone ? Vec2(0) : uvs_[vertex.uv]);
    }
    return result;
  }

 private:
  void read_statement(std::string_view keyword) {
    if (keyword == "v") positions_.push_back(next_vec3("a vertex (v)"));
    if (keyword == "vn") normals_.push_back(next_vec3("a normal (vn)"));
    if (keyword == "vt") uvs_.push_back(next_uv());
    if (keyword == "f") read_face();
  }

  float next_number(std::string_view what, std::string_view how_many) {
    const std::optional<double> number = cursor_.to_word() ? cursor_.number() : std::nullopt;
    if (!number) cursor_.reject(fmt::format("{} needs {} numbers", what, how_many));
    return to_float(*number);
  }

  Vec3 next_vec3(std::string_view what) {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = next_number(what, "three");
    return v;
  }

  Vec2 next_uv() {
    Vec2 uv;
    for (int i = 0; i < 2; ++i) uv[i] = next_number("a texture coordinate (vt)", "two");
    return uv;
  }

  /// The index of what a face names: from 1, or from −1 backwards.
  std::uint32_t next_index(std::string_view what, std::size_t count) {
    const std::optional<std::int64_t> number = cursor_.integer();
    if (!number) cursor_.reject("the corners of a face (f) are written as v, v/vt, v//vn or v/vt/vn");
    const auto limit = static_cast<std::int64_t>(std::min<std::size_t>(count, kNone));
    if (*number == 0 || *number > limit || *number < -limit)
      cursor_.reject(fmt::format("the face uses {} {}, but {} stand before it", what, *number, count));
    return static_cast<std::uint32_t>(*number > 0 ? *number - 1 : limit + *number);
  }

  Corner next_corner() {
    Corner corner;
    corner.position = next_index("position", positions_.size());
    if (!cursor_.skip('/')) return corner;
    const bool is_uv_left_out = cursor_.skip('/');
    if (!is_uv_left_out) {
      corner.uv = next_index("texture coordinate", uvs_.size());
      has_uvs_ = true;
    }
    if (is_uv_left_out || cursor_.skip('/')) {
      corner.normal = next_index("normal", normals_.size());
      has_normals_ = true;
    }
    return corner;
  }

  void read_face() {
    corners_.clear();
    while (cursor_.to_word()) {
      corners_.push_back(next_corner());
    }
    if (corners_.size() == 3) {
      triangle_corners_.insert(triangle_corners_.end(), corners_.begin(), corners_.end());
    } else if (corners_.size() > 3) {
      add_polygon();
    } else {
      ++few_corners_;
    }
  }

  void add_polygon() {
    corner_points_.clear();
    for (const Corner& corner : corners_) corner_points_.push_back(positions_[corner.position]);
    const Triangulation cut = triangulate(corner_points_);
    not_simple_ += cut.is_simple ? 0 : 1;
    for (const auto& triangle : cut.triangles)
      for (const std::uint32_t corner : triangle) triangle_corners_.push_back(corners_[corner]);
  }

  TextCursor cursor_;
  const std::string& name_;
  Diagnostics& diagnostics_;
  std::vector<Point3> positions_;
  std::vector<Vec3> normals_;
  std::vector<Vec2> uvs_;
  std::vector<Corner> triangle_corners_;  ///< three in a row
  bool has_normals_ = false, has_uvs_ = false;
  std::vector<Corner> corners_;  ///< of the face that is being read
  std::vector<Point3> corner_points_;
  std::uint64_t few_corners_ = 0, not_simple_ = 0;
};

}  // namespace

scene::Mesh read_obj(const std::filesystem::path& file, const MeshFileOptions& options, Diagnostics& diagnostics) {
  return parse_obj(read_file_bytes(file), file.string(), options, diagnostics);
}

scene::Mesh parse_obj(std::string_view text, const std::string& name, const MeshFileOptions& options,
                      Diagnostics& diagnostics) {
  ObjReader reader(text, name, diagnostics);
  reader.read();
  ObjReader::Indexed indexed = reader.indexed();
  return finish_mesh(std::move(indexed.mesh), indexed.position_of_vertex, options, name, diagnostics);
}

}  // namespace etendue
