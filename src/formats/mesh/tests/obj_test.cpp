#include "formats/mesh/obj.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"

namespace etendue {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr MeshFileOptions kFlat{.face_normals = true};
constexpr std::string_view kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

scene::Mesh parse(std::string_view text, const MeshFileOptions& options = {}) {
  Diagnostics diagnostics;
  return parse_obj(text, "box.obj", options, diagnostics);
}
scene::Mesh parse_square(const std::string& rest, const MeshFileOptions& options = {}) {
  return parse(std::string(kSquare) + rest, options);
}

float area(const scene::Mesh& mesh) {
  float sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += length(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])) / 2;
  return sum;
}

TEST(Obj, CornersNameAnyOfTheirParts) {
  const std::string data = "vt 0.25 0.75\nvn 0 0 2\n";
  for (const std::string face : {"f 1 2 3\n", "f 1/1 2/1 3/1\n", "f 1//1 2//1 3//1\n", "f 1/1/1 2/1/1 3/1/1"}) {
    SCOPED_TRACE(face);
    const scene::Mesh mesh = parse_square(data + face);
    ASSERT_THAT(mesh.triangles, SizeIs(1));
    ASSERT_THAT(mesh.positions, SizeIs(3));
    EXPECT_EQ(mesh.positions[mesh.triangles[0][2]], Point3(1, 1, 0));
    const bool has_uvs = face.find("/1 ") != face.npos && face.find("//") == face.npos;
    ASSERT_THAT(mesh.uvs, SizeIs(has_uvs ? 3 : 0));
    for (const Vec2& uv : mesh.uvs) EXPECT_EQ(uv, Vec2(0.25f, 0.75f));
    for (const Vec3& normal : mesh.normals) EXPECT_EQ(normal, Vec3(0, 0, 1));
  }
}

TEST(Obj, NegativeIndicesCountBackwards) {
  const scene::Mesh mesh = parse_square("f -4 -3 -2\nv 9 9 9\nf -5 -3 -2\n");
  ASSERT_THAT(mesh.triangles, SizeIs(2));
  EXPECT_EQ(mesh.positions[mesh.triangles[0][0]], Point3(0, 0, 0));
  EXPECT_EQ(mesh.positions[mesh.triangles[1][1]], Point3(1, 1, 0));
  EXPECT_EQ(mesh.positions[mesh.triangles[1][2]], Point3(0, 1, 0));
}

TEST(Obj, PolygonsKeepTheirArea) {
  EXPECT_FLOAT_EQ(area(parse_square("f 1 2 3 4\n")), 1);
  // An arrow head, whose dent lies where a fan would start.
  const scene::Mesh arrow = parse("v 0 0.5 0\nv -1 0 0\nv 0 1.5 0\nv 1 0 0\nf 1 2 3 4\n");
  EXPECT_FLOAT_EQ(area(arrow), 1);
}

TEST(Obj, GroupsAndMaterialsBecomeOneMesh) {
  const scene::Mesh mesh =
      parse_square("mtllib x.mtl\no a\ng b c\nusemtl red\ns 1\nf 1 2 3\no d\nusemtl blue\nf 1 3 4\nl 1 2\n");
  EXPECT_THAT(mesh.triangles, SizeIs(2));
  EXPECT_THAT(mesh.positions, SizeIs(4));
}

TEST(Obj, CommentsJoinedLinesAndForeignLineEndsAreUnderstood) {
  const scene::Mesh mesh =
      parse("# a square\r\nv 0 0 0 1.0 # first\r\nv 1 0 0 \\\r\n\r\nv\t+1 1e0 0\r\n  f 1 \\\n2 3# end");
  EXPECT_THAT(mesh.triangles, SizeIs(1));
  EXPECT_FLOAT_EQ(area(mesh), 0.5f);
}

// A roof over the y axis: the ridge's normals are shared, although its texture coordinates are not.
TEST(Obj, MissingNormalsAreSmoothAcrossSeamsAndWeightedByAngle) {
  const std::string roof =
      "v -1 0 0\nv -1 1 0\nv 0 0 1\nv 0 1 1\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 1\n"
      "f 1/1 3/1 4/1 2/1\nf 3/2 5/2 6/2 4/2\n";
  const scene::Mesh mesh = parse(roof);
  ASSERT_THAT(mesh.positions, SizeIs(8));
  ASSERT_THAT(mesh.normals, SizeIs(8));
  for (std::size_t v = 0; v < 8; ++v) {
    const float x = mesh.positions[v].x;
    const Vec3 expected = x == 0 ? Vec3(0, 0, 1) : normalize(Vec3(x, 0, 1));
    EXPECT_LT(length(mesh.normals[v] - expected), 1e-6f) << "vertex " << v;
  }
  EXPECT_THAT(parse(roof, kFlat).normals, IsEmpty());
}

// A cube's corner: angles, not areas, count, so the diagonal of one face does not draw the normal to its side.
TEST(Obj, SmoothNormalsOfACubesCornerPointAlongItsDiagonal) {
  const scene::Mesh mesh =
      parse("v 0 0 0\nv -1 0 0\nv 0 -1 0\nv 0 0 -1\nv -1 -1 0\nf 1 2 5\nf 1 5 3\nf 1 3 4\nf 1 4 2\n");
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.positions[v] == Point3(0)) {
      EXPECT_LT(length(mesh.normals[v] - normalize(Vec3(1, 1, 1))), 1e-6f);
    }
}

TEST(Obj, OptionsTurnNormalsAndTextureCoordinates) {
  const std::string rest = "vt 0.25 0.75\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n";
  const scene::Mesh mesh = parse_square(rest, {.flip_normals = true, .flip_tex_coords = true});
  EXPECT_EQ(mesh.uvs[0], Vec2(0.25f, 0.25f));
  EXPECT_EQ(mesh.normals[0], Vec3(0, 0, -1));
  const auto& [a, b, c] = mesh.triangles[0];
  EXPECT_LT(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]).z, 0);
}

TEST(Obj, BadDataAreRepairedAndCounted) {
  Diagnostics diagnostics;
  const std::string text = std::string(kSquare) + "v nan 0 0\nv 1e999 0 0\nvn 0 0 0\nvt inf 0\n" +
                           "f 1 2 2\nf 1 2 5\nf 1 2 6\nf 1 2\nf 1/1/1 2/1/1 3/1/1\n";
  const scene::Mesh mesh = parse_obj(text, "box.obj", {}, diagnostics);
  ASSERT_THAT(mesh.triangles, SizeIs(1));
  for (const std::uint32_t v : mesh.triangles[0]) {
    EXPECT_EQ(mesh.normals[v], Vec3(0, 0, 1));
    EXPECT_EQ(mesh.uvs[v], Vec2(0, 0));
  }
  std::string told;
  for (const Diagnostic& d : diagnostics.all()) told += diagnostics.format(d) + "\n";
  EXPECT_THAT(told, HasSubstr("box.obj: a triangle has a position that is not finite; it is left out (2 times"));
  EXPECT_THAT(told, HasSubstr("a triangle has no area"));
  EXPECT_THAT(told, HasSubstr("fewer than three corners"));
  EXPECT_THAT(told, HasSubstr("a normal is missing, zero or not finite"));
  EXPECT_THAT(told, HasSubstr("a texture coordinate is not finite"));
}

TEST(Obj, AFileWithoutFacesIsAnEmptyMeshWithAWarning) {
  Diagnostics diagnostics;
  EXPECT_THAT(parse_obj("", "box.obj", {}, diagnostics).triangles, IsEmpty());
  ASSERT_THAT(diagnostics.all(), SizeIs(1));
  EXPECT_EQ(diagnostics.all()[0].message, "box.obj: there is no triangle in this file");
}

TEST(Obj, MistakesAreToldWithTheirLine) {
  EXPECT_THAT([] { parse("v 0 0\n"); }, ThrowsMessage<Error>("box.obj:1: a vertex (v) needs three numbers"));
  EXPECT_THAT([] { parse_square("vn 0 0 x\n"); }, ThrowsMessage<Error>(HasSubstr("box.obj:5: a normal (vn)")));
  EXPECT_THAT([] { parse_square("f 1 2 5\n"); },
              ThrowsMessage<Error>("box.obj:5: the face uses position 5, but 4 stand before it"));
  EXPECT_THAT([] { parse_square("\nf 1 2 -5\n"); },
              ThrowsMessage<Error>(HasSubstr("box.obj:6: the face uses position -5")));
  EXPECT_THAT([] { parse_square("f 0 1 2\n"); }, ThrowsMessage<Error>(HasSubstr("position 0")));
  EXPECT_THAT([] { parse_square("f 1/1 2/1 3/1\n"); }, ThrowsMessage<Error>(HasSubstr("texture coordinate 1, but 0")));
  EXPECT_THAT([] { parse_square("f 1//1 2//1 3//1\n"); }, ThrowsMessage<Error>(HasSubstr("normal 1, but 0")));
  EXPECT_THAT([] { parse_square("f 1 2 3/\n"); }, ThrowsMessage<Error>(HasSubstr("v/vt/vn")));
  EXPECT_THAT([] { parse_square("f 1 2 99999999999999999999\n"); }, ThrowsMessage<Error>(HasSubstr("box.obj:5")));
}

}  // namespace
}  // namespace etendue
