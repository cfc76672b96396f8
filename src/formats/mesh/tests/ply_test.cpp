#include "formats/mesh/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/error.h"

namespace etendue {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

scene::Mesh parse(const std::string& bytes, const MeshFileOptions& options = {}) {
  Diagnostics diagnostics;
  return parse_ply(bytes, "box.ply", options, diagnostics);
}

template <typename T>
std::string bytes_of(T value, std::endian order) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

const std::string kPosition = "property float x\nproperty float y\nproperty float z\n";
const std::string kCorners = "property list uchar int vertex_indices\n";

std::string ascii(const std::string& vertices, const std::string& faces, const std::string& body) {
  return "ply\nformat ascii 1.0\ncomment by hand\n" + vertices + faces + "end_header\n" + body;
}
std::string square(const std::string& faces, const std::string& body) {
  return ascii("element vertex 4\n" + kPosition, faces, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + body);
}

const scene::MeshAttribute* attribute(const scene::Mesh& mesh, std::string_view name) {
  for (const scene::MeshAttribute& a : mesh.attributes)
    if (a.name == name) return &a;
  return nullptr;
}

TEST(Ply, AsciiTrianglesAndPolygons) {
  const scene::Mesh mesh = parse(square("element face 2\n" + kCorners, "3 0 1 2\n4 0 1 2 3\n"));
  EXPECT_THAT(mesh.positions, SizeIs(4));
  ASSERT_THAT(mesh.triangles, SizeIs(3));
  EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  for (const Vec3& normal : mesh.normals) EXPECT_EQ(normal, Vec3(0, 0, 1));
}

/// A triangle whose vertices have every type, in an unusual order, and lists that nobody needs.
std::string binary_triangle(std::endian order) {
  std::string file = "ply\r\nformat binary_";
  file += order == std::endian::big ? "big" : "little";
  file +=
      "_endian 1.0\r\nelement camera 1\r\nproperty short a\r\nproperty list ushort int8 b\r\n"
      "element vertex 3\r\nproperty float64 z\r\nproperty ushort tag\r\nproperty float32 x\r\nproperty short y\r\n"
      "property float v\r\nproperty float u\r\nproperty list uint8 float extra\r\n"
      "element face 1\r\nproperty list uint uint16 vertex_index\r\nproperty int weight_0\r\nend_header\r\n";
  file += bytes_of<std::int16_t>(-1, order) + bytes_of<std::uint16_t>(3, order) + "abc";
  for (int i = 0; i < 3; ++i) {
    file += bytes_of<double>(0.5, order) + bytes_of<std::uint16_t>(77, order);
    file += bytes_of<float>(i == 1 ? 2.0f : 0.0f, order) + bytes_of<std::int16_t>(i == 2 ? -300 : 0, order);
    file += bytes_of<float>(0.75f, order) + bytes_of<float>(0.25f, order);
    file += bytes_of<std::uint8_t>(static_cast<std::uint8_t>(i), order);
    for (int k = 0; k < i; ++k) file += bytes_of<float>(9, order);
  }
  file += bytes_of<std::uint32_t>(3, order);
  for (const int corner : {0, 1, 2}) file += bytes_of(static_cast<std::uint16_t>(corner), order);
  return file + bytes_of<std::int32_t>(2147483647, order);
}

TEST(Ply, BinaryOfEitherByteOrderInAnyTypesAndOrder) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    SCOPED_TRACE(order == std::endian::big ? "big" : "little");
    const scene::Mesh mesh = parse(binary_triangle(order));
    EXPECT_EQ(mesh.positions, (std::vector<Point3>{{0, 0, 0.5f}, {2, 0, 0.5f}, {0, -300, 0.5f}}));
    EXPECT_EQ(mesh.uvs, std::vector<Vec2>(3, Vec2(0.25f, 0.75f)));
    ASSERT_THAT(mesh.triangles, SizeIs(1));
    ASSERT_TRUE(attribute(mesh, "face_weight"));
    EXPECT_EQ(attribute(mesh, "face_weight")->values, std::vector<float>{1});
  }
}

TEST(Ply, NormalsAndTextureCoordinates) {
  const std::string header =
      "element vertex 3\n" + kPosition +
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n";
  const std::string file = ascii(header, "element face 1\n" + kCorners,
                                 "0 0 0 0 0 5 0.25 0.75\n1 0 0 0 1 0 0 0\n0 1 0 0 0 0 1 1\n3 0 1 2\n");
  const scene::Mesh mesh = parse(file);
  EXPECT_EQ(mesh.normals, (std::vector<Vec3>{{0, 0, 1}, {0, 1, 0}, {0, 0, 1}}));  // the last is mended
  EXPECT_EQ(mesh.uvs[0], Vec2(0.25f, 0.75f));
  EXPECT_EQ(parse(file, {.flip_tex_coords = true}).uvs[0], Vec2(0.25f, 0.25f));
  EXPECT_THAT(parse(file, {.face_normals = true}).normals, IsEmpty());
}

TEST(Ply, PropertiesBecomeAttributes) {
  const std::string vertex =
      "element vertex 3\n" + kPosition +
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float heat_0\nproperty float dir_x\n"
      "property float dir_y\nproperty float dir_z\nproperty float two_0\nproperty float two_1\nproperty float quality\n"
      "property float tint_r\nproperty float tint_g\nproperty float tint_b\n";
  const std::string record = " 0 255 188 7 1 2 3 8 8 8 0.1 0.2 0.3\n";
  const std::string face =
      "element face 2\nproperty float color_0\nproperty float color_1\nproperty float color_2\n" + kCorners;
  const scene::Mesh mesh = parse(ascii(
      vertex, face, "0 0 0" + record + "1 0 0" + record + "0 1 0" + record + "9 9 9 3 0 0 1\n0.5 0.6 0.7 3 0 1 2\n"));
  ASSERT_THAT(mesh.triangles, SizeIs(1)) << "the triangle without area is left out, and its attribute with it";
  ASSERT_THAT(mesh.attributes, SizeIs(5));
  const scene::MeshAttribute* color = attribute(mesh, "vertex_color");
  ASSERT_TRUE(color);
  EXPECT_FALSE(color->per_face);
  ASSERT_THAT(color->values, SizeIs(9));
  EXPECT_EQ(color->values[0], 0);
  EXPECT_EQ(color->values[1], 1);
  EXPECT_NEAR(color->values[2], 0.5029f, 1e-4f);  // IEC 61966-2-1
  ASSERT_TRUE(attribute(mesh, "vertex_heat"));
  EXPECT_EQ(attribute(mesh, "vertex_heat")->channels, 1);
  EXPECT_EQ(attribute(mesh, "vertex_heat")->values, std::vector<float>(3, 7));
  ASSERT_TRUE(attribute(mesh, "vertex_dir"));
  EXPECT_EQ(attribute(mesh, "vertex_dir")->values, (std::vector<float>{1, 2, 3, 1, 2, 3, 1, 2, 3}));
  ASSERT_TRUE(attribute(mesh, "vertex_tint_color"));
  const scene::MeshAttribute* face_color = attribute(mesh, "face_color");
  ASSERT_TRUE(face_color);
  EXPECT_TRUE(face_color->per_face);
  EXPECT_EQ(face_color->values, (std::vector<float>{0.5f, 0.6f, 0.7f}));
}

TEST(Ply, FaceAttributesFollowThePolygonsTriangles) {
  const scene::Mesh mesh =
      parse(square("element face 1\n" + kCorners + "property float weight_0\n", "4 0 1 2 3 0.5\n"));
  ASSERT_THAT(mesh.triangles, SizeIs(2));
  EXPECT_EQ(attribute(mesh, "face_weight")->values, (std::vector<float>{0.5f, 0.5f}));
}

TEST(Ply, LyingCountsAreRejectedBeforeAllocation) {
  const std::string huge = "element vertex 4000000000000\n" + kPosition;
  EXPECT_THAT([&] { parse(ascii(huge, "", "0 0 0\n")); },
              ThrowsMessage<Error>(HasSubstr("the header promises 4000000000000 of \"vertex\"")));
  EXPECT_THAT([&] { parse("ply\nformat binary_little_endian 1.0\n" + huge + "end_header\n0123"); },
              ThrowsMessage<Error>(HasSubstr("more than the 4 bytes that follow can hold")));
  EXPECT_THAT([&] { parse(square("element face 1\n" + kCorners, "255 0 1 2\n")); },
              ThrowsMessage<Error>(HasSubstr("not complete")));
  EXPECT_THAT([&] { parse(square("element face 1\nproperty list double int vertex_indices\n", "9e99 0 1 2\n")); },
              ThrowsMessage<Error>(HasSubstr("must be a whole number")));
  EXPECT_THAT([&] { parse(ascii("element nothing 9000000000000000000\n", "", "")); },
              ThrowsMessage<Error>(HasSubstr("has no properties")));
}

TEST(Ply, TruncatedFilesAreRejected) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string whole = binary_triangle(order);
    for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_THROW(parse(whole.substr(0, size)), Error) << size;
  }
}

TEST(Ply, MistakesAreToldWithTheirPlace) {
  const auto header = [](const std::string& text) { return [text] { parse("ply\n" + text + "\nend_header\n"); }; };
  EXPECT_THAT([] { parse("plywood\n"); }, ThrowsMessage<Error>(HasSubstr("box.ply:1: this is not a PLY file")));
  EXPECT_THAT([] { parse(""); }, ThrowsMessage<Error>(HasSubstr("box.ply:1")));
  EXPECT_THAT(header("format binary_middle_endian 1.0"), ThrowsMessage<Error>(HasSubstr("box.ply:2: the format")));
  EXPECT_THAT(header("element vertex -1"), ThrowsMessage<Error>(HasSubstr("needs a count")));
  EXPECT_THAT(header("property float x"), ThrowsMessage<Error>(HasSubstr("before the first element")));
  EXPECT_THAT(header("element vertex 1\nproperty real x"), ThrowsMessage<Error>(HasSubstr("the type \"real\"")));
  EXPECT_THAT(header("element vertex 0"), ThrowsMessage<Error>(HasSubstr("does not say the format")));
  EXPECT_THAT([] { parse("ply\nformat ascii 1.0\n"); }, ThrowsMessage<Error>(HasSubstr("\"end_header\" is missing")));
  EXPECT_THAT([] { parse(square("element face 1\n" + kCorners, "3 0 1 4\n")); },
              ThrowsMessage<Error>("box.ply:15: a face uses vertex 4, but there are 4, counted from 0"));
  EXPECT_THAT([] { parse(square("element face 1\n" + kCorners, "3 0 1 -1\n")); },
              ThrowsMessage<Error>(HasSubstr("vertex -1")));
  EXPECT_THAT([] { parse(square("element face 1\n" + kCorners, "3 0 1 b\n")); },
              ThrowsMessage<Error>(HasSubstr("box.ply:15: \"b\" is not a number")));
  EXPECT_THAT([] { parse(square("element face 1\n" + kCorners, "300 0 1 2\n")); },
              ThrowsMessage<Error>(HasSubstr("300 does not fit the type")));
  EXPECT_THAT([] { parse(square("element face 1\nproperty int vertex_indices\n", "3\n")); },
              ThrowsMessage<Error>(HasSubstr("the faces have no corners")));
  EXPECT_THAT([] { parse(ascii("element face 1\n" + kCorners, "element vertex 1\n" + kPosition, "1 0\n0 0 0\n")); },
              ThrowsMessage<Error>(HasSubstr("before the vertices")));
  EXPECT_THAT([] { parse(ascii("element vertex 1\nproperty float x\n", "", "0\n")); },
              ThrowsMessage<Error>(HasSubstr("no position")));
}

}  // namespace
}  // namespace etendue
