// Nodes, transforms, the world's axes and unit, lights, cameras, and the one-light rule.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/collada/tests/test_document.h"

namespace etendue::collada {
namespace {

using test::document;
using test::Reading;
using ::testing::HasSubstr;
using ::testing::Not;

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

Transform placed(std::string_view transforms, std::string_view asset = "<up_axis>Y_UP</up_axis>") {
  const Reading reading = test::read(document(
      test::triangle_geometry(), fmt::format("<node>{}<instance_geometry url=\"#g\"/></node>", transforms), asset));
  EXPECT_FALSE(reading.failed) << reading.messages;
  EXPECT_EQ(reading.scene.instances.size(), 1u) << reading.messages;
  return reading.scene.instances.empty() ? Transform() : reading.scene.instances[0].to_world;
}

TEST(Transforms, EachElement) {
  expect_near(placed("<matrix>1 2 3 4 5 6 7 8 9 10 12 12 0 0 0 1</matrix>").point({1, 1, 1}), {10, 26, 43});
  expect_near(placed("<translate>1 2 3</translate>").point({1, 1, 1}), {2, 3, 4});
  expect_near(placed("<rotate>0 0 2 90</rotate>").point({1, 0, 0}), {0, 1, 0});
  expect_near(placed("<scale>1 2 3</scale>").point({1, 1, 1}), {1, 2, 3});
  const Transform look = placed("<lookat>1 2 3 1 2 -7 0 5 0</lookat>");
  expect_near(look.origin, {1, 2, 3});
  expect_near(look.vector({0, 0, -1}), {0, 0, -1});
  const Transform sideways = placed("<lookat>0 0 0 4 0 0 0 1 0</lookat>");
  expect_near(sideways.vector({0, 0, -1}), {1, 0, 0});
  expect_near(sideways.vector({1, 0, 0}), {0, 0, 1});
  const Transform skew = placed("<skew>45 0 1 0 1 0 0</skew>");
  expect_near(skew.point({0, 1, 0}), {1, 1, 0});
  expect_near(skew.point({1, 0, 1}), {1, 0, 1});
}

TEST(Transforms, ApplyInDocumentOrder) {
  expect_near(placed("<translate>1 0 0</translate><scale>2 2 2</scale><rotate>0 1 0 90</rotate>").point({1, 0, 0}),
              {1, 0, -2});
  expect_near(placed("<rotate>0 1 0 90</rotate><scale>2 2 2</scale><translate>1 0 0</translate>").point({1, 0, 0}),
              {0, 0, -4});
}

TEST(Transforms, UpAxes) {
  const auto asset = [](std::string_view axis) { return fmt::format("<up_axis>{}</up_axis>", axis); };
  expect_near(placed("", asset("Y_UP")).point({1, 2, 3}), {1, 2, 3});
  expect_near(placed("", asset("Z_UP")).point({1, 2, 3}), {-1, 3, 2});
  expect_near(placed("", asset("X_UP")).point({1, 2, 3}), {2, 1, -3});
  for (const std::string_view axis : {"X_UP", "Y_UP", "Z_UP"})
    EXPECT_FLOAT_EQ(placed("", asset(axis)).determinant(), 1);
  expect_near(placed("<translate>0 0 5</translate>", asset("Z_UP")).point({0, 0, 0}), {0, 5, 0});
}

TEST(Transforms, UnitMakesMetres) {
  const Transform t = placed("<translate>100 0 0</translate>", "<unit meter=\"0.01\"/><up_axis>Z_UP</up_axis>");
  expect_near(t.point({0, 0, 200}), {-1, 2, 0});
}

TEST(Nodes, NestAndRepeat) {
  const Reading reading = test::read(document(test::triangle_geometry() +
                                                  "<library_nodes><node id=\"part\"><translate>0 1 "
                                                  "0</translate><node><translate>0 0 1</translate><instance_geometry "
                                                  "url=\"#g\"/></node></node></library_nodes>",
                                              "<node name=\"a\"><translate>1 0 0</translate><instance_node "
                                              "url=\"#part\"/><node name=\"b\"><scale>2 2 2</scale><instance_node "
                                              "url=\"#part\"/></node></node>"));
  ASSERT_EQ(reading.scene.instances.size(), 2u) << reading.messages;
  EXPECT_EQ(reading.scene.meshes.size(), 1u);
  expect_near(reading.scene.instances[0].to_world.origin, {1, 1, 1});
  expect_near(reading.scene.instances[1].to_world.origin, {1, 2, 2});
}

TEST(Nodes, SingularTransformsLeaveTheirGeometryOut) {
  for (const std::string_view bad :
       {"<scale>1 0 1</scale>", "<scale>nan 1 1</scale>", "<matrix>1 1 0 0 1 1 0 0 0 0 1 0 0 0 0 1</matrix>"}) {
    const Reading reading = test::read(
        document(test::triangle_geometry(), fmt::format("<node>{}<instance_geometry url=\"#g\"/></node>", bad)));
    EXPECT_FALSE(reading.failed);
    EXPECT_TRUE(reading.scene.instances.empty()) << bad;
    EXPECT_THAT(reading.messages, HasSubstr("singular or not finite"));
  }
  EXPECT_EQ(placed("<scale>1e-6 1e-6 1e-6</scale>").x.x, 1e-6f) << "small is not singular";
  EXPECT_EQ(placed("<scale>1 1 1e-5</scale>").z.z, 1e-5f) << "flat is not singular";
}

TEST(Nodes, SpheresStaySpheres) {
  const std::string sphere =
      "<library_geometries><geometry id=\"g\" name=\"ball\"><extra><technique "
      "profile=\"CGL\"><sphere><radius>.3</radius></sphere>"
      "</technique></extra></geometry></library_geometries>";
  const Reading even = test::read(
      document(sphere, "<node><rotate>1 1 0 30</rotate><scale>2 2 2</scale><instance_geometry url=\"#g\"/></node>",
               "<unit meter=\"0.1\"/>"));
  ASSERT_EQ(even.scene.spheres.size(), 1u) << even.messages;
  EXPECT_FLOAT_EQ(even.scene.spheres[0].radius, 0.3f);
  EXPECT_NEAR(length(even.scene.instances.at(0).to_world.x), 0.2f, 1e-6f);
  EXPECT_THAT(even.messages, Not(HasSubstr("unevenly")));
  const Reading uneven =
      test::read(document(sphere, "<node><scale>1 2 4</scale><instance_geometry url=\"#g\"/></node>"));
  EXPECT_THAT(uneven.messages, HasSubstr("unevenly"));
  EXPECT_FLOAT_EQ(uneven.scene.instances.at(0).to_world.x.x, 2);
  EXPECT_FLOAT_EQ(uneven.scene.instances.at(0).to_world.y.y, 2);
}

/// A scene with one light of this content, in a node with these transforms.
Reading read_light(std::string_view light, std::string_view transforms = "") {
  return test::read(document(fmt::format("<library_lights><light id=\"l\">{}</light></library_lights>", light),
                             fmt::format("<node name=\"lamp\">{}<instance_light url=\"#l\"/></node>", transforms),
                             "<up_axis>Z_UP</up_axis>"));
}

std::string common(std::string_view kind) {
  return fmt::format("<technique_common>{}</technique_common>", kind);
}
std::string cgl(std::string_view kind) {
  return fmt::format("<extra><technique profile=\"CGL\">{}</technique></extra>", kind);
}

template <typename Source>
Source source_of(const Reading& reading) {
  EXPECT_EQ(reading.scene.lights.size(), 1u) << reading.messages;
  if (reading.scene.lights.empty()) return {};
  const auto* source = std::get_if<Source>(&reading.scene.lights[0].source);
  EXPECT_NE(source, nullptr);
  return source == nullptr ? Source{} : *source;
}

TEST(Lights, EveryKindInBothProfiles) {
  for (const auto profile : {common, cgl}) {
    EXPECT_EQ(
        source_of<scene::HemisphereLight>(read_light(profile("<ambient><color>1 2 3</color></ambient>"))).radiance,
        Spectrum(1, 2, 3));
    EXPECT_EQ(source_of<scene::DirectionalLight>(read_light(profile("<directional><color>1 2 3</color></directional>")))
                  .irradiance,
              Spectrum(1, 2, 3));
    EXPECT_EQ(source_of<scene::PointLight>(read_light(profile("<point><color>1 2 3</color></point>"))).intensity,
              Spectrum(1, 2, 3));
    const auto spot = source_of<scene::SpotLight>(read_light(profile(
        "<spot><color>1 2 3</color><falloff_angle>50</falloff_angle><falloff_exponent>2</falloff_exponent></spot>")));
    EXPECT_EQ(spot.intensity, Spectrum(1, 2, 3));
    EXPECT_FLOAT_EQ(spot.cutoff_deg, 25);
    EXPECT_FLOAT_EQ(spot.falloff_exponent, 2);
  }
}

TEST(Lights, CglOverridesCommonAndPlacesRectangles) {
  const Reading reading =
      read_light(common("<point><color>3 3 3</color></point>") + cgl("<area><color>10 9 8</color></area>"),
                 "<matrix>0.6 0 0 0 0 0.8 0 0 0 0 1 1.49 0 0 0 1</matrix>");
  EXPECT_EQ(source_of<scene::RectangleLight>(reading).radiance, Spectrum(10, 9, 8));
  EXPECT_TRUE(reading.scene.uses_cgl_profile);
  const scene::Light& light = reading.scene.lights.at(0);
  EXPECT_EQ(light.name, "lamp");
  expect_near(light.to_world.origin, {0, 1.49f, 0});
  expect_near(light.to_world.vector({0, 0, -1}), {0, -1, 0});
  EXPECT_FLOAT_EQ(length(light.to_world.x), 0.6f);
  EXPECT_FLOAT_EQ(length(light.to_world.y), 0.8f);
}

TEST(Lights, BlackOnesVanishSilently) {
  const Reading reading = read_light(common("<ambient><color>0 0 0</color></ambient>"));
  EXPECT_TRUE(reading.scene.lights.empty());
  EXPECT_EQ(reading.messages, "");
}

TEST(Lights, AttenuationIsMentionedOnce) {
  const std::string two =
      "<library_lights><light id=\"l\"><technique_common><point><color>1 1 "
      "1</color><constant_attenuation>1</constant_attenuation>"
      "</point></technique_common></light></library_lights>";
  const Reading reading =
      test::read(document(two, "<node><instance_light url=\"#l\"/><instance_light url=\"#l\"/></node>"));
  EXPECT_EQ(reading.scene.lights.size(), 2u);
  EXPECT_THAT(reading.messages, HasSubstr("attenuation coefficients of lights are ignored"));
  EXPECT_EQ(std::count(reading.messages.begin(), reading.messages.end(), '\n'), 1);
  const Reading physical =
      read_light(common("<point><color>1 1 "
                        "1</color><constant_attenuation>0</constant_attenuation><quadratic_attenuation>1</"
                        "quadratic_attenuation></point>"));
  EXPECT_EQ(physical.messages, "");
}

/// A rectangle light of 0.6 × 0.8 at height 1.49, shining down (z-up), and an emissive quad of 0.8 × 0.6 at `height`.
Reading read_lamp(std::string_view radiance, std::string_view height, std::string_view quad_offset,
                  bool faces_up = false) {
  const std::string libraries =
      "<library_lights><light id=\"l\"><extra><technique profile=\"CGL\"><area><color>10 10 "
      "10</color></area></technique></extra></light>"
      "</library_lights><library_effects><effect id=\"e\"><extra><technique profile=\"CGL\"><emission><radiance>" +
      std::string(radiance) +
      "</radiance></emission></technique></extra></effect></library_effects><library_materials><material "
      "id=\"m\"><instance_effect "
      "url=\"#e\"/></material></library_materials>" +
      test::geometry("-0.4 -0.3 0 -0.4 0.3 0 0.4 0.3 0 0.4 -0.3 0", 4,
                     fmt::format("<polylist material=\"s\" count=\"1\">{}<vcount>4</vcount><p>{}</p></polylist>",
                                 test::kVertexInput, faces_up ? "3 2 1 0" : "0 1 2 3"));
  return test::read(
      document(libraries,
               fmt::format("<node name=\"Area\"><matrix>0.6 0 0 0 0 0.8 0 0 0 0 1 1.49 0 0 0 1</matrix><instance_light "
                           "url=\"#l\"/></node>"
                           "<node name=\"light\"><translate>{} {}</translate><instance_geometry "
                           "url=\"#g\"><bind_material><technique_common>"
                           "<instance_material symbol=\"s\" "
                           "target=\"#m\"/></technique_common></bind_material></instance_geometry></node>",
                           quad_offset, height),
               "<up_axis>Z_UP</up_axis>"));
}

TEST(OneLight, AQuarterTurnAndAFewMillimetresAreStillOneLight) {
  for (const std::string_view height : {"1.49", "1.495", "1.48"}) {
    const Reading reading = read_lamp("10 10 10", height, "0 0.0043");
    EXPECT_TRUE(reading.scene.lights.empty()) << height;
    EXPECT_EQ(reading.scene.instances.size(), 1u);
    EXPECT_THAT(reading.messages,
                HasSubstr("info: the area light \"Area\" and the emissive mesh \"light\" are one light"));
  }
}

TEST(OneLight, AnotherRadianceInTheSamePlaceIsStillOneLight) {
  const Reading other = read_lamp("5 5 5", "1.49", "0 0");
  EXPECT_TRUE(other.scene.lights.empty());
  EXPECT_THAT(other.messages, HasSubstr("(radiance 10 10 10) lies on the emissive mesh"));
}

TEST(OneLight, ElsewhereAreTwoLights) {
  EXPECT_EQ(read_lamp("10 10 10", "1.40", "0 0").scene.lights.size(), 1u) << "below";
  EXPECT_EQ(read_lamp("10 10 10", "1.49", "0.71 0").scene.lights.size(), 1u) << "beside";
  EXPECT_EQ(read_lamp("10 10 10", "1.49", "0 0", true).scene.lights.size(), 1u) << "facing the other way";
}

scene::Camera camera(std::string_view optics, std::string* messages = nullptr) {
  const Reading reading = test::read(document(
      fmt::format("<library_cameras><camera id=\"c\" "
                  "name=\"eye\"><optics><technique_common>{}</technique_common></optics></camera>"
                  "<camera id=\"d\" name=\"other\"><optics><technique_common><perspective><xfov>10</xfov></perspective>"
                  "</technique_common></optics></camera></library_cameras>",
                  optics),
      "<node><translate>1 2 3</translate><instance_camera url=\"#c\"/></node><node><instance_camera "
      "url=\"#d\"/></node>",
      "<unit meter=\"0.5\"/>"));
  EXPECT_EQ(reading.scene.cameras.size(), 2u) << reading.messages;
  if (messages != nullptr) *messages = reading.messages;
  return reading.scene.cameras.empty() ? scene::Camera() : reading.scene.cameras[0];
}

TEST(Cameras, FieldsOfView) {
  const scene::Camera both = camera(
      "<perspective><xfov>49.13434</xfov><aspect_ratio>1.777778</aspect_ratio><znear>0.1</znear><zfar>100</zfar></"
      "perspective>");
  EXPECT_EQ(both.name, "eye");
  EXPECT_FLOAT_EQ(both.xfov_deg, 49.13434f);
  EXPECT_FLOAT_EQ(both.aspect, 1.777778f);
  EXPECT_FLOAT_EQ(both.near_clip, 0.05f) << "in metres";
  EXPECT_FLOAT_EQ(both.far_clip, 50);
  expect_near(both.to_world.origin, {0.5f, 1, 1.5f});
  const scene::Camera vertical = camera("<perspective><yfov>90</yfov><aspect_ratio>2</aspect_ratio></perspective>");
  EXPECT_NEAR(vertical.xfov_deg, 126.8699f, 1e-3f);  // 2 atan 2
  const scene::Camera angles = camera("<perspective><xfov>126.8699</xfov><yfov>90</yfov></perspective>");
  EXPECT_NEAR(angles.aspect, 2, 1e-4f);
}

TEST(Cameras, StandIns) {
  std::string messages;
  camera("<orthographic><xmag>3</xmag></orthographic>", &messages);
  EXPECT_THAT(messages, HasSubstr("\"eye\" is orthographic; a perspective of 50 degrees takes its place"));
  EXPECT_FLOAT_EQ(camera("<perspective/>", &messages).xfov_deg, 50);
  EXPECT_THAT(messages, HasSubstr("neither xfov nor yfov"));
  EXPECT_FLOAT_EQ(camera("<perspective><xfov>-5</xfov></perspective>", &messages).xfov_deg, 50);
  EXPECT_THAT(messages, HasSubstr("<xfov> is not between 0 and 180"));
}

}  // namespace
}  // namespace etendue::collada
