#include "formats/mesh/serialized.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cstring>

#include "base/error.h"

namespace etendue {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

static_assert(std::endian::native == std::endian::little, "the files are written in the machine's own byte order here");

template <typename T>
std::string bytes_of(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

std::string compressed(const std::string& content) {
  uLongf size = compressBound(content.size());
  std::string result(size, '\0');
  compress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
           content.size());
  return result.substr(0, size);
}

constexpr std::uint32_t kNormals = 1, kUvs = 2, kColors = 8, kSingle = 0x1000, kDouble = 0x2000;

std::string head(std::uint16_t version) {
  return bytes_of<std::uint16_t>(0x041c) + bytes_of(version);
}

/// What a mesh says before its numbers.
std::string preamble(std::uint16_t version, std::uint32_t flags, std::uint64_t vertices, std::uint64_t triangles) {
  return bytes_of(flags) + (version == 4 ? std::string("shard\0", 6) : "") + bytes_of(vertices) + bytes_of(triangles);
}

/// A triangle in the xy plane, its third vertex at (0, size, 0).
template <typename T>
std::string triangle(std::uint16_t version, std::uint32_t flags, float size) {
  std::string content = preamble(version, flags, 3, 1);
  const auto add = [&](const std::vector<float>& numbers) {
    for (const float number : numbers) content += bytes_of(static_cast<T>(number));
  };
  add({0, 0, 0, 1, 0, 0, 0, size, 0});
  if (flags & kNormals) add({0, 0, 2, 0, 1, 0, 1, 0, 0});
  if (flags & kUvs) add({0.25f, 0.75f, 1, 0, 0, 1});
  if (flags & kColors) add({1, 2, 3, 4, 5, 6, 7, 8, 9});
  for (const std::uint32_t corner : {0u, 1u, 2u}) content += bytes_of(corner);
  return head(version) + compressed(content);
}

scene::Mesh parse(const std::string& bytes, int shape_index = 0, const MeshFileOptions& options = {}) {
  Diagnostics diagnostics;
  return parse_serialized(bytes, "rock.serialized", shape_index, options, diagnostics);
}

TEST(Serialized, BothVersionsAndPrecisions) {
  constexpr std::uint32_t kAll = kNormals | kUvs | kColors;
  for (const std::uint16_t version : {std::uint16_t{3}, std::uint16_t{4}})
    for (const bool doubles : {false, true}) {
      SCOPED_TRACE(::testing::Message() << "version " << version << (doubles ? " double" : " single"));
      const scene::Mesh mesh =
          parse(doubles ? triangle<double>(version, kAll | kDouble, 2) : triangle<float>(version, kAll | kSingle, 2));
      EXPECT_EQ(mesh.positions, (std::vector<Point3>{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}));
      EXPECT_EQ(mesh.normals, (std::vector<Vec3>{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}));
      EXPECT_EQ(mesh.uvs, (std::vector<Vec2>{{0.25f, 0.75f}, {1, 0}, {0, 1}}));
      EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
      EXPECT_EQ(mesh.name, version == 4 ? "shard" : "");
    }
}

TEST(Serialized, MissingNormalsAreMadeUnlessFlat) {
  const std::string file = triangle<float>(4, kSingle, 1);
  EXPECT_EQ(parse(file).normals, std::vector<Vec3>(3, Vec3(0, 0, 1)));
  EXPECT_THAT(parse(file, 0, {.face_normals = true}).normals, IsEmpty());
}

template <typename Offset>
std::string three_meshes(std::uint16_t version) {
  std::string file, dictionary;
  for (const float size : {1.0f, 2.0f, 3.0f}) {
    dictionary += bytes_of(static_cast<Offset>(file.size()));
    file += triangle<float>(version, kSingle, size);
  }
  return file + dictionary + bytes_of<std::uint32_t>(3);
}

TEST(Serialized, TheDictionaryAtTheEndFindsEachMesh) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(parse(three_meshes<std::uint32_t>(3), i).positions[2].y, static_cast<float>(i + 1));
    EXPECT_EQ(parse(three_meshes<std::uint64_t>(4), i).positions[2].y, static_cast<float>(i + 1));
  }
}

TEST(Serialized, BadDictionariesAreRejected) {
  const std::string good = three_meshes<std::uint64_t>(4);
  EXPECT_THAT([&] { parse(good, 3); }, ThrowsMessage<Error>(HasSubstr("there is no mesh 3 in this file; it has 3")));
  EXPECT_THAT([&] { parse(good, -1); }, ThrowsMessage<Error>(HasSubstr("must not be negative")));
  const std::string lying_count = good.substr(0, good.size() - 4) + bytes_of<std::uint32_t>(4000000000);
  EXPECT_THAT([&] { parse(lying_count, 1); }, ThrowsMessage<Error>(HasSubstr("claims 4000000000 meshes")));
  const std::string lying_place =
      good.substr(0, good.size() - 20) + bytes_of<std::uint64_t>(1u << 30) + good.substr(good.size() - 12);
  EXPECT_THAT([&] { parse(lying_place, 1); }, ThrowsMessage<Error>(HasSubstr("behind the file's end")));
  std::string wrong_place = good;
  wrong_place[good.size() - 20] = 5;
  EXPECT_THAT([&] { parse(wrong_place, 1); }, ThrowsMessage<Error>(HasSubstr("not a serialized mesh")));
}

TEST(Serialized, LyingCountsAreRejectedBeforeAllocation) {
  const auto file = [](std::uint64_t vertices, std::uint64_t triangles) {
    return head(4) + compressed(preamble(4, kSingle, vertices, triangles));
  };
  EXPECT_THAT([&] { parse(file(4000000000, 1)); }, ThrowsMessage<Error>(HasSubstr("claims 4000000000 vertices")));
  EXPECT_THAT([&] { parse(file(~std::uint64_t{0}, 1)); }, ThrowsMessage<Error>(HasSubstr("more than it can hold")));
  EXPECT_THAT([&] { parse(file(3, ~std::uint64_t{0})); }, ThrowsMessage<Error>(HasSubstr("more than it can hold")));
  EXPECT_THAT([&] { parse(file(3, 1)); }, ThrowsMessage<Error>(HasSubstr("not complete")));
}

TEST(Serialized, DamagedFilesAreRejected) {
  const std::string good = triangle<float>(4, kSingle, 1);
  for (std::size_t size = 0; size + 8 < good.size(); ++size) EXPECT_THROW(parse(good.substr(0, size)), Error) << size;
  EXPECT_THAT([&] { parse("obj " + good); },
              ThrowsMessage<Error>(HasSubstr("rock.serialized: this is not a serialized")));
  EXPECT_THAT([&] { parse(head(5) + good.substr(4)); }, ThrowsMessage<Error>(HasSubstr("version 5")));
  EXPECT_THAT([&] { parse(head(4) + "not compressed at all"); }, ThrowsMessage<Error>(HasSubstr("are damaged")));
  std::string content =
      preamble(4, kSingle, 1, 1) + std::string(12, '\0') + std::string(8, '\0') + bytes_of<std::uint32_t>(1);
  EXPECT_THAT([&] { parse(head(4) + compressed(content)); },
              ThrowsMessage<Error>(HasSubstr("a triangle uses vertex 1")));
}

}  // namespace
}  // namespace etendue
