// The visible scenes of an independent renderer's suite, if they are here.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "formats/formats.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;

TEST(Conformance, AllScenesAreReadInSilence) {
  const char* shared = std::getenv("ETENDUE_SHARED");
  if (shared == nullptr) GTEST_SKIP() << "ETENDUE_SHARED is not set: the conformance scenes are not here";
  std::size_t read = 0;
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(fs::path(shared) / "conformance/mitsuba/tests/scenes")) {
    if (entry.path().extension() != ".xml" || !entry.path().filename().string().starts_with("test_")) continue;
    if (entry.path().filename().string().starts_with("test-scene")) continue;
    SCOPED_TRACE(entry.path().string());
    Diagnostics diagnostics;
    try {
      const scene::SceneDescription scene = read_scene(entry.path(), diagnostics);
      EXPECT_EQ(scene.cameras.size(), 1u);
      EXPECT_FALSE(scene.instances.empty());
      EXPECT_TRUE(scene.format.starts_with("Mitsuba "));
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
    for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << diagnostics.format(d);
    ++read;
  }
  EXPECT_EQ(read, 20u);
}

}  // namespace
}  // namespace etendue
