// The scenes of the teaching renderer, where ETENDUE_SHARED names the folder that has them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "base/error.h"
#include "formats/formats.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

struct Counts {
  std::size_t triangles, spheres, lights;
  bool cgl;
  bool operator==(const Counts&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Counts& c) {
  return out << c.triangles << " triangles, " << c.spheres << " spheres, " << c.lights << " lights, CGL " << c.cgl;
}

fs::path shared_folder() {
  const char* const folder = std::getenv("ETENDUE_SHARED");
  return folder == nullptr ? fs::path() : fs::path(folder);
}

TEST(SharedScenes, AllReadWithTheRightCounts) {
  if (shared_folder().empty()) GTEST_SKIP() << "ETENDUE_SHARED is not set: the cs184 scenes are not here";
  // CBempty's lamp is a point light beside the quad.
  const std::map<std::string, Counts> expected = {{"CBbunny.dae", {28588, 0, 0, true}},
                                                  {"CBcoil.dae", {7884, 0, 0, true}},
                                                  {"CBempty.dae", {12, 0, 1, true}},
                                                  {"CBspheres.dae", {12, 2, 0, true}},
                                                  {"CBspheres_lambertian.dae", {12, 2, 0, true}},
                                                  {"banana.dae", {2458, 0, 2, false}},
                                                  {"bunny.dae", {33696, 0, 1, true}},
                                                  {"bunny_microfacet_cu_unlit.dae", {33696, 0, 0, true}},
                                                  {"bunny_unlit.dae", {33696, 0, 0, true}},
                                                  {"cow.dae", {5856, 0, 1, false}},
                                                  {"teapot.dae", {2464, 0, 1, false}}};
  std::size_t seen = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(shared_folder() / "scenes" / "cs184")) {
    if (entry.path().extension() != ".dae") continue;
    const std::string name = entry.path().filename().string();
    SCOPED_TRACE(name);
    ASSERT_TRUE(expected.contains(name));
    ++seen;
    Diagnostics diagnostics;
    const scene::SceneDescription scene = read_scene(entry.path(), diagnostics);
    Counts counts{0, 0, scene.lights.size(), scene.uses_cgl_profile};
    for (const scene::Instance& instance : scene.instances)
      if (const auto* mesh = std::get_if<scene::Id<scene::Mesh>>(&instance.shape))
        counts.triangles += scene.meshes[mesh->index].triangles.size();
      else
        ++counts.spheres;
    EXPECT_EQ(counts, expected.at(name));
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.format, "COLLADA 1.4.1");
  }
  EXPECT_EQ(seen, expected.size());
}

TEST(SharedScenes, CornellBoxStandsUpright) {
  if (shared_folder().empty()) GTEST_SKIP() << "ETENDUE_SHARED is not set: the cs184 scenes are not here";
  Diagnostics diagnostics;
  const scene::SceneDescription scene = read_scene(shared_folder() / "scenes/cs184/CBspheres.dae", diagnostics);
  for (const scene::Instance& instance : scene.instances) {
    if (instance.name == "Sphere1") {
      EXPECT_LT(length(instance.to_world.origin - Point3(0.4f, 0.3f, 0.3f)), 1e-5f);
    }
    if (instance.name != "light") continue;
    const scene::Mesh& mesh = scene.meshes[std::get<scene::Id<scene::Mesh>>(instance.shape).index];
    EXPECT_NEAR(instance.to_world.point(mesh.positions[0]).y, 1.49f, 1e-4f);
    EXPECT_LT(instance.to_world.normal(mesh.normals[0]).y, -0.9f) << "the lamp shines down";
    EXPECT_EQ(scene.materials[instance.material.index].emission, scene::ColorInput(Spectrum(10)));
  }
}

TEST(SharedScenes, TruncatedDragonSaysSo) {
  if (shared_folder().empty()) GTEST_SKIP() << "ETENDUE_SHARED is not set: dragon-truncated.dae is not here";
  Diagnostics diagnostics;
  try {
    read_scene(shared_folder() / "scenes/broken/dragon-truncated.dae", diagnostics);
    FAIL() << "a truncated file was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.failure(), Failure::input);
    EXPECT_THAT(error.what(), HasSubstr("truncated: it ends in the middle of <float_array>, line 243"));
  }
}

}  // namespace
}  // namespace etendue
