#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/collada/tests/test_document.h"
#include "formats/mesh/polygons.h"
#include "formats/mesh/vertices.h"

namespace etendue::collada {
namespace {

using test::document;
using test::geometry;
using test::kPlaceGeometry;
using test::kVertexInput;
using test::Reading;
using test::source;
using ::testing::HasSubstr;

float area(const scene::Mesh& mesh) {
  float sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += length(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])) / 2;
  return sum;
}

float area(std::span<const Point3> corners, const Triangulation& cut) {
  Vec3 sum(0);
  float absolute = 0;
  for (const auto& [a, b, c] : cut.triangles) {
    const Vec3 twice = cross(corners[b] - corners[a], corners[c] - corners[a]);
    sum += twice;
    absolute += length(twice);
  }
  EXPECT_NEAR(length(sum), absolute, 1e-5f * absolute) << "a triangle is wound the other way";
  return absolute / 2;
}

TEST(Triangulate, ConvexPolygonIsAFan) {
  std::vector<Point3> hexagon;
  for (const float turn : {0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f})
    hexagon.push_back({std::cos(turn * kPi / 3), 2, std::sin(turn * kPi / 3)});
  const Triangulation cut = triangulate(hexagon);
  EXPECT_EQ(cut.triangles.size(), 4u);
  EXPECT_TRUE(cut.is_simple);
  EXPECT_NEAR(area(hexagon, cut), 1.5f * std::sqrt(3.0f), 1e-5f);
}

TEST(Triangulate, AnOutlineThatRunsAroundTwiceIsNotSimple) {
  for (const float start : {0.0f, 0.7f, 3.0f}) {
    std::vector<Point3> pentagram;
    for (int i = 0; i < 5; ++i) {
      const float angle = start + static_cast<float>(i) * 0.8f * kPi;
      pentagram.push_back({std::cos(angle), std::sin(angle), 1});
    }
    EXPECT_FALSE(triangulate(pentagram).is_simple) << start;
    EXPECT_EQ(triangulate(pentagram).triangles.size(), 3u);
  }
}

TEST(Triangulate, NonConvexPolygonsKeepTheirAreaInAnyPlaneAndWinding) {
  // An L, two arrow heads, one with its dent where a fan would start and one elsewhere, and a comb.
  const std::vector<std::vector<Vec2>> shapes = {
      {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
      {{0, 0.5f}, {-1, 0}, {0, 1.5f}, {1, 0}},
      {{-1, 0}, {0, 0.5f}, {1, 0}, {0, 1.5f}},
      {{0, 0}, {5, 0}, {5, 2}, {4, 2}, {4, 1}, {3, 1}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}};
  const float areas[] = {3, 1, 1, 8};
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    float expected = 0;  // shoelace
    for (std::size_t i = 0; i < shapes[s].size(); ++i)
      expected += shapes[s][i].cross(shapes[s][(i + 1) % shapes[s].size()]) / 2;
    EXPECT_FLOAT_EQ(std::abs(expected), areas[s]);
    for (int plane = 0; plane < 3; ++plane)
      for (const bool reversed : {false, true}) {
        std::vector<Point3> corners;
        for (const Vec2& p : shapes[s]) {
          Point3 corner(0.25f);
          corner[plane] = p.x;
          corner[(plane + 1) % 3] = p.y;
          corners.push_back(corner);
        }
        if (reversed) std::reverse(corners.begin(), corners.end());
        const Triangulation cut = triangulate(corners);
        EXPECT_TRUE(cut.is_simple);
        EXPECT_EQ(cut.triangles.size(), corners.size() - 2);
        EXPECT_NEAR(area(corners, cut), std::abs(expected), 1e-5f) << "shape " << s << " plane " << plane;
      }
  }
}

TEST(Triangulate, OutlineThatCrossesItselfIsToldNotFatal) {
  const std::vector<Point3> bow = {{0, 0, 0}, {3, 1, 0}, {3, 0, 0}, {0, 1, 0}, {-1, 3, 0}};
  EXPECT_EQ(triangulate(bow).triangles.size(), 3u);
  const std::vector<Point3> point(5, Point3(1));
  EXPECT_EQ(triangulate(point).triangles.size(), 3u);
}

TEST(VertexTable, EqualCornersAreOneVertexOthersAreNot) {
  VertexTable table;
  table.restart(4);
  EXPECT_EQ(table.vertex({2, 0, 0}), 0u);
  EXPECT_EQ(table.vertex({2, 1, 0}), 1u);
  EXPECT_EQ(table.vertex({3, 0, 0}), 2u);
  EXPECT_EQ(table.vertex({2, 0, 0}), 0u);
  EXPECT_EQ(table.vertex({2, 0, 1}), 3u);
  table.restart(4);
  EXPECT_EQ(table.vertex({2, 1, 0}), 0u);
  EXPECT_EQ(table.vertices().size(), 1u);
}

TEST(Geometry, SeparateIndexStreamsBecomeOne) {
  // Two triangles over a square: along the diagonal position 0 shares its normal but not its uv; position 2 shares
  // both.
  const std::string mesh =
      geometry("0 0 0 1 0 0 1 1 0 0 1 0", 4,
               source("n", "0 0 1", 1) + source("t", "0 0 1 0 1 1 0 1 0.5 0.5", 5, 2) +
                   fmt::format("<triangles count=\"2\">{}<input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/>"
                               "<input semantic=\"TEXCOORD\" source=\"#t\" offset=\"2\" set=\"0\"/>"
                               "<p>0 0 0 1 0 1 2 0 2  0 0 4 2 0 2 3 0 3</p></triangles>",
                               kVertexInput));
  const Reading reading = test::read(document(mesh, kPlaceGeometry));
  ASSERT_FALSE(reading.failed) << reading.messages;
  ASSERT_EQ(reading.scene.meshes.size(), 1u);
  const scene::Mesh& m = reading.scene.meshes[0];
  EXPECT_EQ(m.name, "shape");
  EXPECT_EQ(m.positions.size(), 5u);
  EXPECT_EQ(m.normals.size(), 5u);
  ASSERT_EQ(m.uvs.size(), 5u);
  ASSERT_EQ(m.triangles.size(), 2u);
  EXPECT_EQ(m.triangles[0][2], m.triangles[1][1]);
  EXPECT_NE(m.triangles[0][0], m.triangles[1][0]);
  EXPECT_EQ(m.positions[m.triangles[0][0]], m.positions[m.triangles[1][0]]);
  EXPECT_EQ(m.uvs[m.triangles[1][0]], Vec2(0.5f, 0.5f));
  EXPECT_EQ(m.uvs[m.triangles[0][0]], Vec2(0, 0));
  EXPECT_FLOAT_EQ(area(m), 1);
}

TEST(Geometry, EveryPrimitiveKindCoversTheSquare) {
  const std::string_view kinds[] = {
      "<triangles count=\"2\">{}<p>0 1 2 0 2 3</p></triangles>",
      "<polylist count=\"1\">{}<vcount>4</vcount><p>0 1 2 3</p></polylist>",
      "<polygons count=\"2\">{}<p>0 1 2</p><p>0 2 3</p></polygons>",
      "<trifans count=\"1\">{}<p>0 1 2 3</p></trifans>",
      "<tristrips count=\"1\">{}<p>0 1 3 2</p></tristrips>",
  };
  for (const std::string_view kind : kinds) {
    const Reading reading = test::read(document(
        geometry("0 0 0 1 0 0 1 1 0 0 1 0", 4, fmt::format(fmt::runtime(kind), kVertexInput)), kPlaceGeometry));
    ASSERT_EQ(reading.scene.meshes.size(), 1u) << kind << reading.messages;
    const scene::Mesh& m = reading.scene.meshes[0];
    EXPECT_FLOAT_EQ(area(m), 1) << kind;
    EXPECT_EQ(m.positions.size(), 4u) << kind;
    EXPECT_TRUE(m.normals.empty());
    for (const auto& [a, b, c] : m.triangles)
      EXPECT_GT(cross(m.positions[b] - m.positions[a], m.positions[c] - m.positions[a]).z, 0) << kind;
  }
}

TEST(Geometry, NormalsInsideVerticesTakeThePositionsIndex) {
  const std::string mesh = fmt::format(
      "<library_geometries><geometry id=\"g\"><mesh>{}{}<vertices id=\"v\"><input semantic=\"POSITION\" "
      "source=\"#p\"/><input semantic=\"NORMAL\" source=\"#n\"/></vertices><triangles count=\"1\">{}<p>2 1 "
      "0</p></triangles>"
      "</mesh></geometry></library_geometries>",
      source("p", "0 0 0 1 0 0 0 1 0", 3), source("n", "0 0 -1 0 -3 0 -4 0 0", 3), kVertexInput);
  const Reading reading = test::read(document(mesh, kPlaceGeometry));
  ASSERT_EQ(reading.scene.meshes.size(), 1u) << reading.messages;
  const scene::Mesh& m = reading.scene.meshes[0];
  ASSERT_EQ(m.normals.size(), 3u);
  EXPECT_EQ(m.normals[m.triangles[0][0]], Vec3(-1, 0, 0));  // made unit
  EXPECT_EQ(m.normals[m.triangles[0][2]], Vec3(0, 0, -1));  // kept, though the triangle is wound against it
}

TEST(Geometry, AccessorsSkipAndShare) {
  // One array for two sources: positions at 0, 1, 2 of each group of six, normals at 3, 4, 5; the first number is a
  // pad.
  const std::string mesh = fmt::format(
      "<library_geometries><geometry id=\"g\"><mesh>"
      "<source id=\"p\"><float_array id=\"a\" count=\"19\">9 0 0 0 0 0 1 1 0 0 0 1 0 0 1 0 1 0 0</float_array>"
      "<technique_common><accessor source=\"#a\" count=\"3\" offset=\"1\" stride=\"6\"><param name=\"X\"/><param "
      "name=\"Y\"/>"
      "<param name=\"Z\"/></accessor></technique_common></source>"
      "<source id=\"n\"><technique_common><accessor source=\"#a\" count=\"3\" offset=\"1\" "
      "stride=\"6\"><param/><param/>"
      "<param/><param name=\"X\"/><param name=\"Y\"/><param name=\"Z\"/></accessor></technique_common></source>"
      "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
      "<triangles count=\"1\">{}<input semantic=\"NORMAL\" source=\"#n\" offset=\"0\"/><p>0 1 2</p></triangles>"
      "</mesh></geometry></library_geometries>",
      kVertexInput);
  const Reading reading = test::read(document(mesh, kPlaceGeometry));
  ASSERT_EQ(reading.scene.meshes.size(), 1u) << reading.messages;
  const scene::Mesh& m = reading.scene.meshes[0];
  EXPECT_EQ(m.positions[1], Point3(1, 0, 0));
  EXPECT_EQ(m.normals[0], Vec3(0, 0, 1));
  EXPECT_EQ(m.normals[1], Vec3(0, 1, 0));
  EXPECT_EQ(m.normals[2], Vec3(1, 0, 0));
}

TEST(Geometry, NumbersInAllTheirSpellings) {
  const std::string mesh = geometry("+0 .0 -0e5 1.<!-- a remark -->0E0\t1e-400\r\n<![CDATA[0 0 1]]> 0 1e1 nan -1.#IND",
                                    4, fmt::format("<triangles count=\"1\">{}<p>0 1 +2</p></triangles>", kVertexInput));
  const Reading reading = test::read(document(mesh, kPlaceGeometry));
  EXPECT_TRUE(reading.failed);  // "1." and "0E0" are parted by a remark: thirteen numbers, not twelve
  EXPECT_THAT(reading.messages, HasSubstr("says count=\"12\", but holds 13 numbers"));

  const std::string good = geometry("+0 .0 -0e5 1.0E0\t1e-400\r\n<![CDATA[0 0 1]]> 0 <!-- a remark --> 1e1 nan -1.#IND",
                                    4, fmt::format("<triangles count=\"1\">{}<p>0 1 +2</p></triangles>", kVertexInput));
  const Reading second = test::read(document(good, kPlaceGeometry));
  ASSERT_EQ(second.scene.meshes.size(), 1u) << second.messages;
  EXPECT_EQ(second.scene.meshes[0].positions, (std::vector<Point3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(Geometry, BadTrianglesAndNormalsAreRepairedAndCounted) {
  const std::string mesh =
      geometry("0 0 0 1 0 0 0 1 0 nan 0 0 2 0 0", 5,
               source("n", "0 0 0 0 0 1 inf 0 0", 3) +
                   fmt::format("<triangles count=\"4\">{}<input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/>"
                               "<p>0 0 1 1 2 2   0 1 1 1 3 1   0 1 1 1 4 1   0 1 0 1 2 1</p></triangles>",
                               kVertexInput));
  const Reading reading = test::read(document(mesh, kPlaceGeometry));
  ASSERT_EQ(reading.scene.meshes.size(), 1u) << reading.messages;
  const scene::Mesh& m = reading.scene.meshes[0];
  ASSERT_EQ(m.triangles.size(), 1u);
  EXPECT_EQ(m.positions.size(), 3u) << "vertices of dropped triangles stay away";
  for (const Vec3& normal : m.normals) EXPECT_EQ(normal, Vec3(0, 0, 1));
  EXPECT_THAT(reading.messages, HasSubstr("position that is not finite; it is left out"));
  EXPECT_THAT(reading.messages, HasSubstr("a triangle has no area; it is left out (2 times"));
  EXPECT_THAT(reading.messages, HasSubstr("a normal is zero or not finite; the triangle's own is used (2 times"));
}

TEST(Geometry, PrimitivesWithDifferentMaterialsAreDifferentMeshes) {
  const std::string mesh =
      geometry("0 0 0 1 0 0 1 1 0 0 1 0", 4,
               fmt::format("<triangles material=\"a\" count=\"1\">{0}<p>0 1 2</p></triangles>"
                           "<triangles material=\"b\" count=\"1\">{0}<p>0 2 3</p></triangles>",
                           kVertexInput)) +
      "<library_effects><effect id=\"e\"><profile_COMMON><technique><lambert><diffuse><color>0.1 0.2 0.3 1</color>"
      "</diffuse></lambert></technique></profile_COMMON></effect></library_effects>"
      "<library_materials><material id=\"m%20b\"><instance_effect url=\"#e\"/></material></library_materials>";
  const Reading reading = test::read(
      document(mesh,
               "<node><instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"b\" "
               "target=\"#m b\"/></technique_common></bind_material></instance_geometry></node>"));
  ASSERT_FALSE(reading.failed) << reading.messages;
  ASSERT_EQ(reading.scene.meshes.size(), 2u);
  ASSERT_EQ(reading.scene.instances.size(), 2u);
  const auto reflectance = [&](std::size_t i) {
    const auto& material = reading.scene.materials[reading.scene.instances[i].material.index];
    return std::get<Spectrum>(std::get<scene::DiffuseMaterial>(material.surface).reflectance);
  };
  EXPECT_EQ(reflectance(0), Spectrum(0.5f));
  EXPECT_EQ(reflectance(1), Spectrum(0.1f, 0.2f, 0.3f));
  EXPECT_THAT(reading.messages, HasSubstr("no material is bound"));
}

TEST(Geometry, AnInstancedGeometryIsReadOnce) {
  const Reading reading =
      test::read(document(test::triangle_geometry(),
                          "<node><instance_geometry url=\"#g\"/><node><instance_geometry url=\"#g\"/></node></node>"));
  EXPECT_EQ(reading.scene.meshes.size(), 1u);
  EXPECT_EQ(reading.scene.instances.size(), 2u);
}

TEST(Geometry, IndexOutOfRangeIsReportedAtTheNumber) {
  const std::string text =
      document(geometry("0 0 0 1 0 0 0 1 0", 3,
                        fmt::format("\n<triangles count=\"1\">{}\n<p>0 1\n 7</p></triangles>", kVertexInput)),
               kPlaceGeometry);
  const Reading reading = test::read(text);
  EXPECT_TRUE(reading.failed);
  EXPECT_THAT(reading.messages, HasSubstr("test.dae:4:2: error: the index 7 is out of range: there are 3"));
}

TEST(Geometry, ManyVerticesAtOnePositionTakeNoQuadraticTime) {
  // A fan of slivers around one position, each with its own texture coordinate there.
  constexpr int kSlivers = 60000;
  std::string positions = "0 0 0 ", uvs, p;
  for (int i = 0; i <= kSlivers; ++i) {
    positions += fmt::format("{} {} 0 ", std::cos(i * 1e-4), std::sin(i * 1e-4));
    uvs += fmt::format("{} 0 ", i);
  }
  for (int i = 0; i < kSlivers; ++i) p += fmt::format("0 {} {} 0 {} 0 ", i, i + 1, i + 2);
  const Reading reading = test::read(document(
      geometry(
          positions, kSlivers + 2,
          source("t", uvs, kSlivers + 1, 2) +
              fmt::format("<triangles count=\"{}\">{}<input semantic=\"TEXCOORD\" source=\"#t\" offset=\"1\"/><p>{}</p>"
                          "</triangles>",
                          kSlivers, kVertexInput, p)),
      kPlaceGeometry));
  ASSERT_EQ(reading.scene.meshes.size(), 1u) << reading.messages;
  EXPECT_EQ(reading.scene.meshes[0].triangles.size(), static_cast<std::size_t>(kSlivers));
}

}  // namespace
}  // namespace etendue::collada
