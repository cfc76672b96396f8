#include "formats/formats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "formats/collada/tests/test_document.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A folder of its own for each test, gone afterwards.
class ReadScene : public ::testing::Test {
 protected:
  ReadScene() {
    folder_ = fs::temp_directory_path() /
              fmt::format("etendue-{}-{}", ::testing::UnitTest::GetInstance()->current_test_info()->name(), ::getpid());
    fs::create_directories(folder_);
  }
  ~ReadScene() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }

  static std::string failure(const fs::path& path) {
    Diagnostics diagnostics;
    try {
      read_scene(path, diagnostics);
    } catch (const Error& error) {
      EXPECT_EQ(error.failure(), Failure::input);
      return error.what();
    }
    return "no failure";
  }

  fs::path folder_;
};

TEST_F(ReadScene, ReadsByExtensionWhateverItsCase) {
  Diagnostics diagnostics;
  const auto text = collada::test::document(collada::test::triangle_geometry(), collada::test::kPlaceGeometry);
  for (const char* const name : {"a.dae", "b.DAE"}) {
    const fs::path path = write(name, text);
    const scene::SceneDescription scene = read_scene(path, diagnostics);
    EXPECT_EQ(scene.format, "COLLADA 1.4.1");
    EXPECT_EQ(scene.file, path);
    EXPECT_EQ(scene.instances.size(), 1u);
  }
}

TEST_F(ReadScene, KnowsColladaUnderAnotherName) {
  Diagnostics diagnostics;
  const fs::path path = write(
      "scene.xml", "\xef\xbb\xbf<?xml version=\"1.0\"?>\n<!-- here -->\n" +
                       collada::test::document(collada::test::triangle_geometry(), collada::test::kPlaceGeometry));
  EXPECT_EQ(read_scene(path, diagnostics).meshes.size(), 1u);
}

TEST_F(ReadScene, SaysWhatIsWrongWithThePath) {
  EXPECT_THAT(failure(folder_ / "none.dae"), HasSubstr("none.dae: there is no such file"));
  EXPECT_THAT(failure(folder_), HasSubstr("this is a folder"));
  EXPECT_THAT(failure(write("empty.dae", "")), HasSubstr("empty.dae: the file is empty"));
  EXPECT_THAT(failure(write("cow.obj", "v 0 0 0\n")),
              HasSubstr("scene files that end in \".obj\" are not known; known are .dae (COLLADA)"));
  EXPECT_THAT(failure(write("cow", "v 0 0 0\n")), HasSubstr("without extension are not known"));
}

TEST_F(ReadScene, TexturesAreLookedForBesideTheScene) {
  write("wood.png", "not read here");
  const fs::path path = write(
      "a.dae",
      collada::test::document(
          collada::test::triangle_geometry() +
              "<library_images><image id=\"i\"><init_from>C:\\pictures\\wood.png</init_from></image></library_images>"
              "<library_effects><effect id=\"e\"><profile_COMMON><technique><lambert><diffuse><texture "
              "texture=\"i\"/></diffuse>"
              "</lambert></technique></profile_COMMON></effect></library_effects>"
              "<library_materials><material id=\"m\"><instance_effect url=\"#e\"/></material></library_materials>",
          "<node><instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"m\" "
          "target=\"#m\"/>"
          "</technique_common></bind_material></instance_geometry></node>"));
  Diagnostics diagnostics;
  const scene::SceneDescription scene = read_scene(path, diagnostics);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(std::get<scene::BitmapTexture>(scene.textures[0].source).file, folder_ / "wood.png");
}

TEST(SceneFormats, AreNamedAndRecognisable) {
  ASSERT_FALSE(scene_formats().empty());
  for (const SceneFormat& format : scene_formats()) {
    EXPECT_FALSE(format.name.empty());
    ASSERT_FALSE(format.extensions.empty());
    for (const std::string_view extension : format.extensions) EXPECT_TRUE(extension.starts_with('.'));
  }
}

}  // namespace
}  // namespace etendue
