#include "formats/mesh/serialized.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "base/error.h"
#include "formats/file_bytes.h"
#include "formats/mesh/finish.h"
#include "formats/text_cursor.h"

namespace etendue {
namespace {

constexpr std::uint16_t kMagic = 0x041c;
constexpr std::size_t kMostInflation = 1032;  ///< bytes that one byte of a deflate stream can become (RFC 1951)

[[noreturn]] void reject(const std::string& name, std::string_view message) {
  throw Error(Failure::input, fmt::format("{}: {}", name, message));
}

/// The bytes that a zlib stream (RFC 1950) holds, as they are asked for.
class InflatedBytes {
 public:
  InflatedBytes(std::string_view compressed, const std::string& name)
      : name_(name), compressed_size_(compressed.size()) {
    // zlib takes its input through a pointer that is not const, but does not write there.
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
    stream_.avail_in = static_cast<uInt>(std::min<std::size_t>(compressed.size(), std::numeric_limits<uInt>::max()));
    if (inflateInit(&stream_) != Z_OK) throw Error(Failure::internal, "zlib could not be started");
  }
  ~InflatedBytes() { inflateEnd(&stream_); }
  InflatedBytes(const InflatedBytes&) = delete;
  InflatedBytes& operator=(const InflatedBytes&) = delete;

  /// No more bytes than this can be inside.
  std::uint64_t most() const { return std::uint64_t{compressed_size_} * kMostInflation; }

  template <typename T>
  T next() {
    char bytes[sizeof(T)];
    fill(bytes, sizeof(T));
    return load_number<T>(bytes, std::endian::little);
  }

  /// `count` numbers stored as T, each made into a Result. Memory grows only as the stream yields.
  template <typename T, typename Result, typename Convert>
  std::vector<Result> next_numbers(std::uint64_t count, Convert convert) {
    constexpr std::size_t kPiece = 1 << 14;
    std::vector<Result> result;
    std::vector<char> bytes(kPiece * sizeof(T));
    while (result.size() < count) {
      const auto piece = static_cast<std::size_t>(std::min<std::uint64_t>(kPiece, count - result.size()));
      fill(bytes.data(), piece * sizeof(T));
      for (std::size_t i = 0; i < piece; ++i)
        result.push_back(convert(load_number<T>(bytes.data() + i * sizeof(T), std::endian::little)));
    }
    return result;
  }

 private:
  void fill(char* bytes, std::size_t count) {
    stream_.next_out = reinterpret_cast<Bytef*>(bytes);
    stream_.avail_out = static_cast<uInt>(count);
    while (stream_.avail_out > 0) {
      const int status = inflate(&stream_, Z_NO_FLUSH);
      if (stream_.avail_out == 0) return;
      if (status == Z_STREAM_END || status == Z_BUF_ERROR)
        reject(name_, "the mesh ends where more numbers should follow; the file is not complete");
      if (status != Z_OK)
        reject(name_, fmt::format("the compressed data are damaged ({})", stream_.msg ? stream_.msg : "zlib"));
    }
  }

  const std::string& name_;
  std::size_t compressed_size_;
  z_stream stream_{};
};

/// Version and place of the mesh with that index, from the dictionary at the file's end.
struct MeshPlace {
  std::uint16_t version = 0;
  std::string_view compressed;
};

template <typename Offset>
std::uint64_t mesh_offset(std::string_view bytes, const std::string& name, std::uint64_t index) {
  if (bytes.size() < sizeof(std::uint32_t)) reject(name, "the file is too short");
  const char* end = bytes.data() + bytes.size() - sizeof(std::uint32_t);
  const auto count = load_number<std::uint32_t>(end, std::endian::little);
  if (index >= count)
    reject(name, fmt::format("there is no mesh {} in this file; it has {}, counted from 0", index, count));
  if (count > (bytes.size() - sizeof(std::uint32_t)) / sizeof(Offset))
    reject(name, fmt::format("the file claims {} meshes, but is too short for their places", count));
  return load_number<Offset>(end - sizeof(Offset) * (count - index), std::endian::little);
}

MeshPlace find_mesh(std::string_view bytes, const std::string& name, int shape_index) {
  const auto version_at = [&](std::string_view mesh) {
    ByteReader reader(mesh, name);
    if (reader.next<std::uint16_t>() != kMagic)
      reject(name, "this is not a serialized mesh: its first bytes are others");
    const auto version = reader.next<std::uint16_t>();
    if (version != 3 && version != 4)
      reject(name, fmt::format("version {} of serialized meshes is not known; known are 3 and 4", version));
    return version;
  };
  if (shape_index < 0) reject(name, fmt::format("shape_index is {}; it must not be negative", shape_index));
  const std::uint16_t version = version_at(bytes);
  if (shape_index > 0) {
    const auto index = static_cast<std::uint64_t>(shape_index);
    const std::uint64_t offset =
        version == 3 ? mesh_offset<std::uint32_t>(bytes, name, index) : mesh_offset<std::uint64_t>(bytes, name, index);
    if (offset >= bytes.size()) reject(name, fmt::format("mesh {} would lie behind the file's end", shape_index));
    bytes.remove_prefix(offset);
    version_at(bytes);
  }
  return {version, bytes.substr(2 * sizeof(std::uint16_t))};
}

/// Flags in front of a mesh.
struct Contents {
  bool normals, uvs, colors, doubles;
};

Contents contents_of(std::uint32_t flags) {
  return {(flags & 0x1) != 0, (flags & 0x2) != 0, (flags & 0x8) != 0, (flags & 0x2000) != 0};
}

std::vector<float> next_floats(InflatedBytes& stream, std::uint64_t count, bool doubles) {
  if (doubles) return stream.next_numbers<double, float>(count, to_float);
  return stream.next_numbers<float, float>(count, [](float value) { return value; });
}

std::vector<Vec3> next_vec3s(InflatedBytes& stream, std::uint64_t count, bool doubles) {
  const std::vector<float> numbers = next_floats(stream, 3 * count, doubles);
  std::vector<Vec3> result;
  result.reserve(numbers.size() / 3);
  for (std::size_t i = 0; i < numbers.size(); i += 3) result.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  return result;
}

std::vector<Vec2> next_vec2s(InflatedBytes& stream, std::uint64_t count, bool doubles) {
  const std::vector<float> numbers = next_floats(stream, 2 * count, doubles);
  std::vector<Vec2> result;
  result.reserve(numbers.size() / 2);
  for (std::size_t i = 0; i < numbers.size(); i += 2) result.emplace_back(numbers[i], numbers[i + 1]);
  return result;
}

std::string next_string(InflatedBytes& stream) {
  std::string text;
  for (char c = stream.next<char>(); c != '\0'; c = stream.next<char>()) text += c;
  return text;
}

/// Throws if the stream cannot hold as much as it claims.
void check_counts(const InflatedBytes& stream, const Contents& contents, std::uint64_t vertices,
                  std::uint64_t triangles, const std::string& name) {
  const std::uint64_t numbers =
      3u + (contents.normals ? 3u : 0u) + (contents.uvs ? 2u : 0u) + (contents.colors ? 3u : 0u);
  const std::uint64_t vertex_size = numbers * (contents.doubles ? sizeof(double) : sizeof(float));
  const std::uint64_t triangle_size = 3 * sizeof(std::uint32_t);
  constexpr std::uint64_t kMostVertices = std::numeric_limits<std::uint32_t>::max();
  if (vertices > kMostVertices || vertices > stream.most() / vertex_size || triangles > stream.most() / triangle_size)
    reject(name,
           fmt::format("the file claims {} vertices and {} triangles, more than it can hold", vertices, triangles));
}

scene::Mesh read_mesh(const MeshPlace& place, const std::string& name) {
  InflatedBytes stream(place.compressed, name);
  const Contents contents = contents_of(stream.next<std::uint32_t>());
  scene::Mesh mesh;
  if (place.version == 4) mesh.name = next_string(stream);
  const auto vertices = stream.next<std::uint64_t>(), triangles = stream.next<std::uint64_t>();
  check_counts(stream, contents, vertices, triangles, name);
  mesh.positions = next_vec3s(stream, vertices, contents.doubles);
  if (contents.normals) mesh.normals = next_vec3s(stream, vertices, contents.doubles);
  if (contents.uvs) mesh.uvs = next_vec2s(stream, vertices, contents.doubles);
  if (contents.colors) next_floats(stream, 3 * vertices, contents.doubles);

  const std::vector<std::uint32_t> corners =
      stream.next_numbers<std::uint32_t, std::uint32_t>(3 * triangles, [&](std::uint32_t index) {
        if (index >= vertices)
          reject(name, fmt::format("a triangle uses vertex {}, but there are {}, counted from 0", index, vertices));
        return index;
      });
  mesh.triangles.reserve(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  return mesh;
}

}  // namespace

scene::Mesh read_serialized(const std::filesystem::path& file, int shape_index, const MeshFileOptions& options,
                            Diagnostics& diagnostics) {
  return parse_serialized(read_file_bytes(file), file.string(), shape_index, options, diagnostics);
}

scene::Mesh parse_serialized(std::string_view bytes, const std::string& name, int shape_index,
                             const MeshFileOptions& options, Diagnostics& diagnostics) {
  return finish_mesh(read_mesh(find_mesh(bytes, name, shape_index), name), {}, options, name, diagnostics);
}

}  // namespace etendue
