#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/mitsuba/tests/test_scene.h"

namespace etendue::mitsuba {
namespace {

using test::read;
using test::Reading;
using ::testing::HasSubstr;

constexpr const char* kSphere = "<shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>";

float radius(const Reading& reading) {
  EXPECT_FALSE(reading.failed) << reading.messages;
  return reading.scene.spheres.at(0).radius;
}

TEST(Document, ValuesFromOutsideComeBeforeDefaults) {
  const std::string scene = std::string("<default name=\"r\" value=\"2\"/>") + kSphere;
  EXPECT_EQ(radius(read(scene)), 2);
  EXPECT_EQ(radius(read(scene, "3.0.0", {{"r", "5"}})), 5);
}

TEST(Document, TheLongestNameIsMeant) {
  EXPECT_EQ(
      radius(read("<default name=\"ra\" value=\"2\"/><default name=\"r\" value=\"3\"/><shape type=\"sphere\"><float "
                  "name=\"radius\" value=\"$ra0\"/></shape>")),
      20);
}

TEST(Document, UndefinedAndUnusedNames) {
  const Reading undefined = read(std::string("<default name=\"rr\" value=\"1\"/>") + kSphere);
  EXPECT_TRUE(undefined.failed);
  EXPECT_THAT(undefined.messages, HasSubstr("test.xml:2:"));
  EXPECT_THAT(undefined.messages, HasSubstr("nothing defines $r"));
  const Reading unused = read("<default name=\"spp\" value=\"1\"/>", "3.0.0", {{"sp", "4"}});
  EXPECT_FALSE(unused.failed);
  EXPECT_THAT(unused.messages, HasSubstr("does not ask for $sp; did you mean \"spp\"?"));
}

TEST(Document, ReferencesForwardsAndByAlias) {
  const Reading reading = read(
      "<shape type=\"sphere\"><ref id=\"b\"/></shape><shape type=\"sphere\"><ref id=\"c\"/></shape>"
      "<bsdf type=\"conductor\" id=\"b\"/><alias id=\"b\" as=\"c\"/>");
  ASSERT_FALSE(reading.failed) << reading.messages;
  EXPECT_EQ(reading.scene.materials.size(), 1u);
  EXPECT_EQ(reading.scene.instances[0].material, reading.scene.instances[1].material);
}

TEST(Document, BadReferences) {
  EXPECT_THAT(read("<shape type=\"sphere\"><ref id=\"gloss\"/></shape><bsdf type=\"diffuse\" id=\"glass\"/>").messages,
              HasSubstr("nothing has the id \"gloss\"; did you mean \"glass\"?"));
  EXPECT_THAT(
      read("<bsdf type=\"mask\" id=\"a\"><ref id=\"b\"/></bsdf><bsdf type=\"mask\" id=\"b\"><ref id=\"a\"/></bsdf>")
          .messages,
      HasSubstr("contains itself"));
  EXPECT_THAT(read("<bsdf type=\"diffuse\" id=\"a\"/><bsdf type=\"diffuse\" id=\"a\"/>").messages,
              HasSubstr("the id \"a\" is taken already"));
  EXPECT_THAT(read("<alias id=\"a\" as=\"b\"/>").messages, HasSubstr("nothing above has the id \"a\""));
}

TEST(Document, IncludesAndFolders) {
  const test::Folder folder;
  folder.add("parts/ball.xml",
             "<scene version=\"2.0.0\"><include filename=\"size.xml\"/><shape type=\"sphere\"><float name=\"radius\" "
             "value=\"$r\"/></shape></scene>");
  folder.add("parts/size.xml", "<scene version=\"2.0.0\"><default name=\"r\" value=\"7\"/></scene>");
  folder.add("parts/coat.xml", "<bsdf version=\"2.0.0\" type=\"conductor\" id=\"coat\"/>");
  folder.add("data/line.txt", "0 0 0 1\n1 0 0 2\n2 0 0 1\n\n0 1 0 1\n0 2 0 1\n");
  const Reading reading = test::read_text(
      "<scene version=\"3.0.0\"><path value=\"data\"/><include filename=\"parts/ball.xml\"/><include "
      "filename=\"parts/coat.xml\"/><shape type=\"linearcurve\"><string name=\"filename\" value=\"line.txt\"/><ref "
      "id=\"coat\"/></shape></scene>",
      folder.path() / "scene.xml");
  EXPECT_EQ(radius(reading), 7);
  EXPECT_EQ(reading.scene.curves.at(0).segments, (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_EQ(reading.messages, "");
}

TEST(Document, IncludesThatDoNotWork) {
  const test::Folder folder;
  folder.add("a.xml", "<scene version=\"2.0.0\"><include filename=\"b.xml\"/></scene>");
  folder.add("b.xml", "<scene version=\"2.0.0\"><include filename=\"a.xml\"/></scene>");
  const auto outcome = [&](std::string_view content) {
    return test::read_text(fmt::format("<scene version=\"3.0.0\">{}</scene>", content), folder.path() / "scene.xml")
        .messages;
  };
  EXPECT_THAT(outcome("<include filename=\"a.xml\"/>"), HasSubstr("a.xml includes itself"));
  EXPECT_THAT(outcome("<include filename=\"none.xml\"/>"), HasSubstr("there is no file \"none.xml\" in "));
  EXPECT_THAT(outcome("<path value=\"none\"/>"), HasSubstr("there is no folder \"none\""));
}

TEST(Document, OldNamesAreUpgraded) {
  const Reading reading = read(
      "<shape type=\"sphere\"><transform name=\"toWorld\"><translate x=\"3\"/></transform><bsdf type=\"dielectric\">"
      "<float name=\"intIOR\" value=\"1.5\"/><float name=\"extIOR\" value=\"1\"/></bsdf></shape>"
      "<shape type=\"disk\"><bsdf type=\"diffuse\"><rgb name=\"diffuseReflectance\" value=\"0.25\"/></bsdf></shape>"
      "<sensor type=\"perspective\"><transform name=\"toWorld\"><lookAt origin=\"0,0,5\" target=\"0,0,0\" "
      "up=\"0,1,0\"/></transform></sensor>",
      "0.6.0");
  ASSERT_FALSE(reading.failed) << reading.messages;
  EXPECT_EQ(reading.scene.instances[0].to_world.origin.x, 3);
  EXPECT_EQ(std::get<scene::GlassMaterial>(reading.scene.materials[0].surface).ior, 1.5f);
  EXPECT_EQ(std::get<scene::DiffuseMaterial>(reading.scene.materials[1].surface).reflectance,
            scene::ColorInput(Spectrum(0.25f)));
  EXPECT_TRUE(read("<shape type=\"sphere\"><transform name=\"toWorld\"/></shape>").failed);
}

TEST(Document, WrongElementsAndAttributes) {
  EXPECT_THAT(read("<shpae type=\"sphere\"/>").messages, HasSubstr("no element <shpae>; did you mean \"shape\"?"));
  EXPECT_THAT(read("<shape typ=\"sphere\"/>").messages,
              HasSubstr("<shape> has no attribute \"typ\"; did you mean \"type\"?"));
  EXPECT_THAT(read("<shape/>").messages, HasSubstr("<shape> needs the attribute \"type\""));
  EXPECT_THAT(read("<translate x=\"1\"/>").messages, HasSubstr("stands in a <transform> only"));
  EXPECT_THAT(
      read("<shape type=\"sphere\"><float name=\"radius\" value=\"1\"><float name=\"r\" value=\"2\"/></float></shape>")
          .messages,
      HasSubstr("<float> holds no elements"));
  EXPECT_THAT(test::read_text("<mesh version=\"3.0.0\"/>").messages, HasSubstr("no element <mesh>"));
  EXPECT_THAT(test::read_text("<bsdf type=\"null\" version=\"3.0.0\"/>").messages, HasSubstr("not <scene>"));
  EXPECT_THAT(test::read_text("<scene/>").messages, HasSubstr("which version"));
  EXPECT_THAT(test::read_text("<scene version=\"new\"/>").messages, HasSubstr("is not like \"3.0.0\""));
}

TEST(Document, UnknownPropertiesAndPlugins) {
  const Reading typo = read("<shape type=\"sphere\"><float name=\"raduis\" value=\"1\"/></shape>");
  EXPECT_TRUE(typo.failed);
  EXPECT_THAT(
      typo.messages,
      HasSubstr("test.xml:2:22: error: <shape type=\"sphere\"> has no property \"raduis\"; did you mean \"radius\"?"));
  EXPECT_THAT(read("<shape type=\"sphere\"><film type=\"hdrfilm\"/></shape>").messages,
              HasSubstr("has no use for a <film>"));
  const Reading unknown =
      read("<shape type=\"sdfgrid\"/><emitter type=\"sunsky\"/><shape type=\"disk\"><bsdf type=\"hair\"/></shape>");
  EXPECT_FALSE(unknown.failed);
  EXPECT_THAT(unknown.messages, HasSubstr("the shape \"sdfgrid\" is not known here; it is left out"));
  EXPECT_THAT(unknown.messages, HasSubstr("the emitter \"sunsky\" is not known here; it is left out"));
  EXPECT_THAT(unknown.messages, HasSubstr("the bsdf \"hair\" is not known here; a diffuse grey (0.5) is used"));
}

TEST(Document, WrongValues) {
  const auto of = [](std::string_view property) {
    return read(fmt::format("<shape type=\"sphere\">{}</shape>", property)).messages;
  };
  EXPECT_THAT(of("<float name=\"radius\" value=\"big\"/>"), HasSubstr("\"big\" is not a number"));
  EXPECT_THAT(of("<float name=\"radius\" value=\"1e999\"/>"), HasSubstr("\"1e999\" is not a finite number"));
  EXPECT_THAT(of("<rgb name=\"radius\" value=\"1\"/>"), HasSubstr("is a <rgb>; it needs to be a <float>"));
  EXPECT_THAT(of("<boolean name=\"flip_normals\" value=\"maybe\"/>"), HasSubstr("neither true nor false"));
  EXPECT_THAT(of("<point name=\"center\" value=\"1 2\"/>"), HasSubstr("has 2 numbers; it needs three"));
  EXPECT_THAT(of("<transform name=\"to_world\"><rotate angle=\"1\"/></transform>"), HasSubstr("needs an axis"));
  EXPECT_THAT(of("<transform name=\"to_world\"><lookat origin=\"0 0 0\" target=\"0 0 1\" up=\"0 0 1\"/></transform>"),
              HasSubstr("along its own \"up\""));
  EXPECT_THAT(of("<transform name=\"to_world\"><matrix value=\"1 2 3\"/></transform>"),
              HasSubstr("has 3 numbers; it needs 16 or 9"));
}

TEST(Document, NothingUnfoldsWithoutEnd) {
  std::string content = "<default name=\"a\" value=\"xxxxxxxxxx\"/>";
  for (char c = 'a'; c < 'j'; ++c) {
    std::string tenfold;
    for (int i = 0; i < 10; ++i) tenfold += fmt::format("${}", c);
    content += fmt::format("<default name=\"{}\" value=\"{}\"/>", static_cast<char>(c + 1), tenfold);
  }
  EXPECT_THAT(read(content).messages, HasSubstr("too long"));
  std::string nested;
  for (int i = 0; i < 100000; ++i) nested += "<bsdf type=\"mask\">";
  EXPECT_TRUE(read(nested).failed);
  std::string chain = "<bsdf type=\"null\" id=\"b0\"/>";
  for (int i = 0; i < 1000; ++i)
    chain += fmt::format("<bsdf type=\"mask\" id=\"b{}\"><ref id=\"b{}\"/></bsdf>", i + 1, i);
  EXPECT_THAT(read(chain).messages, HasSubstr("nested more than 100 deep"));
}

}  // namespace
}  // namespace etendue::mitsuba
