// Triangles at the end of float arithmetic are told of.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/diagnostics.h"
#include "render/render_scene.h"

namespace etendue {
namespace {

std::string messages_for_edges_of(float length) {
  scene::SceneDescription scene;
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {length, 0, 0}, {0, length, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.materials.push_back({"", scene::DiffuseMaterial{Spectrum(0.5f)}, {}, {}});
  scene.instances.push_back({"", scene::Id<scene::Mesh>{0}, scene::Id<scene::Material>{0}, {}, {}});
  Diagnostics diagnostics;
  compile(scene, {}, diagnostics);
  std::string messages;
  for (const Diagnostic& diagnostic : diagnostics.all()) messages += diagnostics.format(diagnostic);
  return messages;
}

TEST(TinyTriangles, AreToldOfWhereDigitsAreLost) {
  EXPECT_EQ(messages_for_edges_of(1), "");
  EXPECT_EQ(messages_for_edges_of(1e-8f), "");
  for (const float length : {1e-9f, 1e-10f, 1e-11f})
    EXPECT_THAT(messages_for_edges_of(length), testing::HasSubstr("a larger <unit> helps")) << length;
}

}  // namespace
}  // namespace etendue
