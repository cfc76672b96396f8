#include "formats/mesh/ply.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "formats/file_bytes.h"
#include "formats/mesh/finish.h"
#include "formats/mesh/ply_attributes.h"
#include "formats/mesh/ply_header.h"
#include "formats/mesh/polygons.h"
#include "formats/text_cursor.h"

namespace etendue {
namespace {

using ply::Element;
using ply::Type;

/// The numbers behind the header, one after the other.
class Body {
 public:
  Body(const ply::Header& header, const std::string& name)
      : order_(header.byte_order), bytes_(header.body), text_(header.body, name, header.body_line), name_(name) {}

  double next(Type type) { return order_ ? next_binary(type) : next_ascii(type); }

  /// The length of a list.
  std::size_t next_count(Type type) {
    const double count = next(type);
    if (!(count >= 0)) reject(fmt::format("a list cannot have {} numbers", count));
    return static_cast<std::size_t>(count);
  }

  /// Throws if what is left cannot hold all of the element.
  void check_count(const Element& element) const {
    std::size_t least = 0;  // bytes of one of them; a number of a text is a digit and a space
    for (const ply::Property& property : element.properties)
      least += order_ ? ply::size_of(property.count.value_or(property.type)) : 2;
    if (element.count == 0) return;
    if (least == 0) reject(fmt::format("the element \"{}\" has no properties", element.name));
    const std::size_t left = order_ ? bytes_.size() : text_.left() + 1;
    if (element.count > left / least)
      reject(fmt::format("the header promises {} of \"{}\", more than the {} bytes that follow can hold", element.count,
                         element.name, left));
  }

  [[noreturn]] void reject(std::string_view message) const {
    if (!order_) text_.reject(message);
    throw Error(Failure::input, fmt::format("{}: {}", name_, message));
  }

 private:
  double next_binary(Type type) {
    const std::size_t size = ply::size_of(type);
    if (bytes_.size() < size) reject("the file ends where more numbers should follow; it is not complete");
    const char* bytes = bytes_.data();
    bytes_.remove_prefix(size);
    switch (type) {
      case Type::int8:
        return load_number<std::int8_t>(bytes, *order_);
      case Type::uint8:
        return load_number<std::uint8_t>(bytes, *order_);
      case Type::int16:
        return load_number<std::int16_t>(bytes, *order_);
      case Type::uint16:
        return load_number<std::uint16_t>(bytes, *order_);
      case Type::int32:
        return load_number<std::int32_t>(bytes, *order_);
      case Type::uint32:
        return load_number<std::uint32_t>(bytes, *order_);
      case Type::float32:
        return load_number<float>(bytes, *order_);
      case Type::float64:
        break;
    }
    return load_number<double>(bytes, *order_);
  }

  double next_ascii(Type type) {
    if (!text_.to_word_in_any_line()) reject("the file ends where more numbers should follow; it is not complete");
    const std::optional<double> number = text_.number();
    if (!number) reject(fmt::format("\"{}\" is not a number", text_.word().substr(0, 40)));
    const double most = ply::largest(type);
    if (most > 0 && !(std::abs(*number) <= most && *number == std::floor(*number)))
      reject(fmt::format("{} does not fit the type that the header states", *number));
    return *number;
  }

  std::optional<std::endian> order_;
  std::string_view bytes_;
  TextCursor text_;
  const std::string& name_;
};

/// sRGB's transfer function (IEC 61966-2-1), decoded.
double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// Takes a mesh's attributes out of an element's records.
class AttributeReader {
 public:
  AttributeReader(scene::Mesh& mesh, const Element& element, const std::string& prefix, bool per_face)
      : mesh_(mesh),
        element_(element),
        attributes_(ply::find_attributes(element, prefix)),
        first_(mesh.attributes.size()) {
    for (const ply::Attribute& attribute : attributes_)
      mesh.attributes.push_back({attribute.name, per_face, static_cast<int>(attribute.properties.size()), {}});
  }

  /// Adds the values of one vertex, or of one triangle.
  void add(const std::vector<double>& record) {
    for (std::size_t a = 0; a < attributes_.size(); ++a)
      for (const std::size_t p : attributes_[a].properties)
        mesh_.attributes[first_ + a].values.push_back(value(element_.properties[p].type, record[p]));
  }

 private:
  static float value(Type type, double number) {
    const double most = ply::largest(type);
    return most > 0 ? static_cast<float>(decode_srgb(number / most)) : to_float(number);
  }

  scene::Mesh& mesh_;
  const Element& element_;
  std::vector<ply::Attribute> attributes_;
  std::size_t first_;
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& name)
      : name_(name), header_(ply::read_header(bytes, name)), body_(header_, name) {}

  scene::Mesh read(Diagnostics& diagnostics) {
    for (const Element& element : header_.elements) {
      body_.check_count(element);
      if (element.name == "vertex" && !has_vertices_)
        read_vertices(element);
      else if (element.name == "face" && !has_faces_)
        read_faces(element);
      else
        skip(element);
    }
    constexpr std::string_view kFewCorners = "a face has fewer than three corners; it is left out";
    constexpr std::string_view kNotSimple =
        "a face's outline crosses itself or has too many corners; its area may be wrong";
    if (few_corners_ > 0) diagnostics.repaired(fmt::format("{}: {}", name_, kFewCorners), {}, few_corners_);
    if (not_simple_ > 0) diagnostics.repaired(fmt::format("{}: {}", name_, kNotSimple), {}, not_simple_);
    return std::move(mesh_);
  }

 private:
  /// Where an element's properties of these names stand; nothing unless all are there.
  template <std::size_t N>
  static std::optional<std::array<std::size_t, N>> find_all(const Element& element,
                                                            const std::array<std::string_view, N>& names) {
    std::array<std::size_t, N> places{};
    for (std::size_t i = 0; i < N; ++i) {
      const std::optional<std::size_t> place = element.find(names[i]);
      if (!place || element.properties[*place].count) return std::nullopt;
      places[i] = *place;
    }
    return places;
  }

  static std::optional<std::array<std::size_t, 2>> find_uv(const Element& element) {
    for (const std::array<std::string_view, 2>& names :
         {std::array<std::string_view, 2>{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}})
      if (const auto places = find_all<2>(element, names)) return places;
    return std::nullopt;
  }

  Vec3 vec3(const std::array<std::size_t, 3>& places) const {
    return {to_float(record_[places[0]]), to_float(record_[places[1]]), to_float(record_[places[2]])};
  }

  /// Reads one record: its numbers into record_ (0 for lists), the list `list` into corners_.
  void next_record(const Element& element, std::optional<std::size_t> list) {
    record_.assign(element.properties.size(), 0);
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const ply::Property& property = element.properties[i];
      if (!property.count)
        record_[i] = body_.next(property.type);
      else if (i == list)
        next_corners(property);
      else
        for (std::size_t left = body_.next_count(*property.count); left > 0; --left) body_.next(property.type);
    }
  }

  void next_corners(const ply::Property& property) {
    corners_.clear();
    for (std::size_t left = body_.next_count(*property.count); left > 0; --left) {
      const double index = body_.next(property.type);
      if (!(index >= 0 && index < static_cast<double>(mesh_.positions.size()) && index == std::floor(index)))
        body_.reject(
            fmt::format("a face uses vertex {}, but there are {}, counted from 0", index, mesh_.positions.size()));
      corners_.push_back(static_cast<std::uint32_t>(index));
    }
  }

  void skip(const Element& element) {
    for (std::size_t i = 0; i < element.count; ++i) next_record(element, std::nullopt);
  }

  void read_vertices(const Element& element) {
    has_vertices_ = true;
    const auto position = find_all<3>(element, {"x", "y", "z"}), normal = find_all<3>(element, {"nx", "ny", "nz"});
    const auto uv = find_uv(element);
    if (!position) body_.reject("the vertices have no position: properties x, y and z");
    if (element.count > std::numeric_limits<std::uint32_t>::max()) body_.reject("there are too many vertices");
    mesh_.positions.reserve(element.count);
    if (normal) mesh_.normals.reserve(element.count);
    if (uv) mesh_.uvs.reserve(element.count);
    AttributeReader attributes(mesh_, element, "vertex_", false);
    for (std::size_t i = 0; i < element.count; ++i) {
      next_record(element, std::nullopt);
      mesh_.positions.push_back(vec3(*position));
      if (normal) mesh_.normals.push_back(vec3(*normal));
      if (uv) mesh_.uvs.push_back({to_float(record_[(*uv)[0]]), to_float(record_[(*uv)[1]])});
      attributes.add(record_);
    }
  }

  void read_faces(const Element& element) {
    has_faces_ = true;
    if (!has_vertices_) body_.reject("the faces stand before the vertices");
    std::optional<std::size_t> list = element.find("vertex_indices");
    if (!list) list = element.find("vertex_index");
    if (!list || !element.properties[*list].count)
      body_.reject("the faces have no corners: a list property vertex_indices");
    mesh_.triangles.reserve(element.count);
    AttributeReader attributes(mesh_, element, "face_", true);
    for (std::size_t i = 0; i < element.count; ++i) {
      next_record(element, list);
      for (const Triangle& triangle : next_triangles()) {
        mesh_.triangles.push_back(triangle);
        attributes.add(record_);
      }
    }
  }

  /// The triangles of the polygon corners_.
  std::span<const Triangle> next_triangles() {
    triangles_.clear();
    if (corners_.size() == 3) {
      triangles_.push_back({corners_[0], corners_[1], corners_[2]});
    } else if (corners_.size() > 3) {
      corner_points_.clear();
      for (const std::uint32_t corner : corners_) corner_points_.push_back(mesh_.positions[corner]);
      const Triangulation cut = triangulate(corner_points_);
      not_simple_ += cut.is_simple ? 0 : 1;
      for (const auto& [a, b, c] : cut.triangles) triangles_.push_back({corners_[a], corners_[b], corners_[c]});
    } else {
      ++few_corners_;
    }
    return triangles_;
  }

  const std::string& name_;
  ply::Header header_;
  Body body_;
  scene::Mesh mesh_;
  bool has_vertices_ = false, has_faces_ = false;
  std::vector<double> record_;
  std::vector<std::uint32_t> corners_;  ///< of the face that is being read
  std::vector<Point3> corner_points_;
  std::vector<Triangle> triangles_;
  std::uint64_t few_corners_ = 0, not_simple_ = 0;
};

}  // namespace

scene::Mesh read_ply(const std::filesystem::path& file, const MeshFileOptions& options, Diagnostics& diagnostics) {
  return parse_ply(read_file_bytes(file), file.string(), options, diagnostics);
}

scene::Mesh parse_ply(std::string_view bytes, const std::string& name, const MeshFileOptions& options,
                      Diagnostics& diagnostics) {
  return finish_mesh(PlyReader(bytes, name).read(diagnostics), {}, options, name, diagnostics);
}

}  // namespace etendue
