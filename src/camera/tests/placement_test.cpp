#include "camera/placement.h"

#include <gtest/gtest.h>

namespace etendue {
namespace {

Bounds3 box(const Point3& min, const Point3& max) {
  Bounds3 bounds;
  bounds.extend(min);
  bounds.extend(max);
  return bounds;
}

scene::SceneDescription scene_with(const scene::Camera& camera, bool cgl = false) {
  scene::SceneDescription scene;
  scene.cameras = {camera};
  scene.uses_cgl_profile = cgl;
  return scene;
}

float xfov_deg(const Camera& camera) {
  return 2 * degrees(std::atan(camera.tan_half_x));
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

void expect_orthonormal_right_handed(const Transform& m) {
  EXPECT_NEAR(length(m.x), 1, 1e-5f);
  EXPECT_NEAR(length(m.y), 1, 1e-5f);
  expect_near(cross(m.x, m.y), m.z);
}

const Bounds3 kBox = box({-1, 0, -2}, {3, 4, 2});

TEST(Placement, FitKeepsThePixelSizeOfTheTeachingRenderer) {
  scene::Camera file;
  file.xfov_deg = 49.13434f;
  file.aspect = 1.333333f;
  Diagnostics diagnostics;
  const auto scene = scene_with(file, true);
  const Camera small = place_camera(scene, kBox, CameraPlacement::fit, 480, 360, diagnostics);
  EXPECT_NEAR(xfov_deg(small), 30.7f, 0.05f);
  const Camera whole = place_camera(scene, kBox, CameraPlacement::fit, 800, 600, diagnostics);
  EXPECT_NEAR(xfov_deg(whole), 49.13434f, 1e-3f);
  const Camera wide = place_camera(scene, kBox, CameraPlacement::fit, 1600, 600, diagnostics);
  EXPECT_FLOAT_EQ(wide.tan_half_x, 2 * whole.tan_half_x);
  EXPECT_FLOAT_EQ(wide.tan_half_y, whole.tan_half_y);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_NE(diagnostics.all()[0].message.find("the middle 480 x 360 of its 800 x 600 view"), std::string::npos);
}

TEST(Placement, FitGrowsTheFilesFieldOfViewToFourByThree) {
  scene::Camera narrow, wide;
  narrow.xfov_deg = wide.xfov_deg = 40;
  narrow.aspect = 1;
  wide.aspect = 2;
  Diagnostics diagnostics;
  const float x = std::tan(radians(20.0f));
  const Camera a = place_camera(scene_with(narrow), kBox, CameraPlacement::fit, 800, 600, diagnostics);
  EXPECT_FLOAT_EQ(a.tan_half_y, x);
  EXPECT_FLOAT_EQ(a.tan_half_x, x * 4 / 3);
  const Camera b = place_camera(scene_with(wide), kBox, CameraPlacement::fit, 800, 600, diagnostics);
  EXPECT_FLOAT_EQ(b.tan_half_x, x);
  EXPECT_FLOAT_EQ(b.tan_half_y, x * 3 / 4);
}

TEST(Placement, FitLooksAtTheBoxFromWhereTheMatrixSendsMinusZ) {
  scene::Camera file;  // M·(0,0,−1) = (2, 1, −1) + (0, 0, 3) = (2, 1, 2): the translation counts
  file.to_world = Transform{{1, 0, 0}, {0, 1, 0}, {-2, -1, 1}, {0, 0, 3}};
  Diagnostics diagnostics;
  const Camera camera = place_camera(scene_with(file), kBox, CameraPlacement::fit, 800, 600, diagnostics);
  const float distance = 1.5f * kBox.diagonal();
  const Vec3 towards_camera = Vec3(2, 1, 2) / 3.0f;
  expect_near(camera.to_world.origin, kBox.center() + towards_camera * distance, 1e-4f);
  expect_near(camera.to_world.z, towards_camera);
  EXPECT_NEAR(camera.to_world.x.y, 0, 1e-6f) << "world y is up";
  EXPECT_GT(camera.to_world.y.y, 0);
  expect_orthonormal_right_handed(camera.to_world);
  const FilmPoint seen = project(camera, kBox.center());
  EXPECT_NEAR(seen.film.x, 0.5f, 1e-5f);
  EXPECT_NEAR(seen.film.y, 0.5f, 1e-5f);
  EXPECT_NEAR(seen.distance, distance, 1e-4f);
}

TEST(Placement, FitFromStraightAboveAndBelowKeepsXToTheRight) {
  for (const float side : {1.0f, -1.0f}) {
    scene::Camera file;
    file.to_world = Transform::rotation({1, 0, 0}, side * kPi / 2);  // (0,0,−1) ↦ (0, side, 0)
    Diagnostics diagnostics;
    const Camera camera = place_camera(scene_with(file), kBox, CameraPlacement::fit, 800, 600, diagnostics);
    expect_near(camera.to_world.z, {0, side, 0});
    expect_near(camera.to_world.x, {1, 0, 0});
  }
}

TEST(Placement, FitWarnsWhenTheFarPlaneCutsTheScene) {
  scene::Camera file;
  file.near_clip = 0.1f;
  file.far_clip = 5;
  Diagnostics diagnostics;
  const Camera camera = place_camera(scene_with(file), kBox, CameraPlacement::fit, 800, 600, diagnostics);
  EXPECT_EQ(camera.near_clip, 0.1f);
  EXPECT_EQ(camera.far_clip, 5);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].severity, Severity::warning);
  EXPECT_NE(diagnostics.all()[0].message.find("beyond 5"), std::string::npos) << diagnostics.all()[0].message;

  Diagnostics none;
  file.far_clip = 100;
  place_camera(scene_with(file), kBox, CameraPlacement::fit, 800, 600, none);
  EXPECT_TRUE(none.all().empty());
}

TEST(Placement, FitWithoutADirectionIsSeenFromTheFront) {
  scene::Camera file;
  file.to_world = Transform::translation({0, 0, 1});
  Diagnostics diagnostics;
  const Camera camera = place_camera(scene_with(file), kBox, CameraPlacement::fit, 800, 600, diagnostics);
  expect_near(camera.to_world.z, {0, 0, 1});
  EXPECT_EQ(diagnostics.all().size(), 1u);
}

TEST(Placement, FileTakesTheCameraAsItStands) {
  scene::Camera file;
  file.to_world = Transform::translation({1, 2, 3}) * Transform::rotation({0, 1, 0}, 0.5f);
  file.near_clip = 0.25f;
  file.far_clip = 50;
  file.xfov_deg = 60;
  file.aspect = 2;
  Diagnostics diagnostics;
  const Camera same = place_camera(scene_with(file), kBox, CameraPlacement::file, 200, 100, diagnostics);
  EXPECT_NEAR(xfov_deg(same), 60, 1e-4f);
  EXPECT_FLOAT_EQ(same.tan_half_x, 2 * same.tan_half_y);
  expect_near(same.to_world.origin, {1, 2, 3});
  expect_near(same.to_world.z, file.to_world.z);
  EXPECT_EQ(same.near_clip, 0.25f);
  EXPECT_EQ(same.far_clip, 50);

  const Camera narrow = place_camera(scene_with(file), kBox, CameraPlacement::file, 100, 100, diagnostics);
  EXPECT_FLOAT_EQ(narrow.tan_half_x, same.tan_half_x);
  EXPECT_FLOAT_EQ(narrow.tan_half_y, same.tan_half_x) << "grown along the too-narrow side";
  const Camera wide = place_camera(scene_with(file), kBox, CameraPlacement::file, 400, 100, diagnostics);
  EXPECT_FLOAT_EQ(wide.tan_half_y, same.tan_half_y);
  EXPECT_FLOAT_EQ(wide.tan_half_x, 4 * same.tan_half_y);
  EXPECT_TRUE(diagnostics.all().empty());
}

TEST(Placement, AutomaticIsFitForTheProfileAndFileForAllOthers) {
  scene::Camera file;
  file.to_world = Transform::translation({0, 0, 7});
  Diagnostics diagnostics;
  const Camera cgl = place_camera(scene_with(file, true), kBox, CameraPlacement::automatic, 800, 600, diagnostics);
  EXPECT_NEAR(length(cgl.to_world.origin - kBox.center()), 1.5f * kBox.diagonal(), 1e-3f);
  const Camera other = place_camera(scene_with(file, false), kBox, CameraPlacement::automatic, 800, 600, diagnostics);
  expect_near(other.to_world.origin, {0, 0, 7});
}

TEST(Placement, ScaledAndMirroredCamerasAreRepaired) {
  scene::Camera file;
  file.to_world =
      Transform::translation({0, 0, 5}) * Transform::rotation({0, 1, 0}, 0.3f) * Transform::scaling({2, 3, 0.5f});
  Diagnostics scaled;
  const Camera a = place_camera(scene_with(file), kBox, CameraPlacement::file, 800, 600, scaled);
  expect_orthonormal_right_handed(a.to_world);
  expect_near(a.to_world.z, Transform::rotation({0, 1, 0}, 0.3f).z);
  ASSERT_EQ(scaled.all().size(), 1u);
  EXPECT_NE(scaled.all()[0].message.find("scaled"), std::string::npos);

  file.to_world = Transform::scaling({-1, 1, 1});
  Diagnostics mirrored;
  const Camera b = place_camera(scene_with(file), kBox, CameraPlacement::file, 800, 600, mirrored);
  expect_near(b.to_world.x, {1, 0, 0});
  expect_near(b.to_world.z, {0, 0, 1});
  ASSERT_EQ(mirrored.all().size(), 1u);
  EXPECT_NE(mirrored.all()[0].message.find("mirrored"), std::string::npos);
}

TEST(Placement, SingularCameraFallsBackToFraming) {
  scene::Camera file;
  file.to_world = Transform::scaling({1, 0, 1});
  Diagnostics diagnostics;
  const Camera camera = place_camera(scene_with(file), kBox, CameraPlacement::file, 800, 600, diagnostics);
  expect_orthonormal_right_handed(camera.to_world);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_NE(diagnostics.all()[0].message.find("singular"), std::string::npos);
}

TEST(Placement, ImpossibleFieldOfViewIsReplaced) {
  scene::Camera file;
  file.xfov_deg = 200;
  Diagnostics diagnostics;
  const Camera camera = place_camera(scene_with(file), kBox, CameraPlacement::file, 800, 600, diagnostics);
  EXPECT_NEAR(xfov_deg(camera), 50, 1e-3f);
  EXPECT_EQ(diagnostics.all().size(), 1u);
}

TEST(Placement, SceneWithoutCameraIsFramedWhole) {
  for (const auto& [width, height] : {std::pair{800, 600}, {100, 900}, {900, 100}})
    for (const CameraPlacement placement : {CameraPlacement::automatic, CameraPlacement::file, CameraPlacement::fit}) {
      Diagnostics diagnostics;
      const Camera camera = place_camera({}, kBox, placement, width, height, diagnostics);
      ASSERT_EQ(diagnostics.all().size(), 1u);
      EXPECT_EQ(diagnostics.all()[0].severity, Severity::info);
      for (const float x : {kBox.min.x, kBox.max.x})
        for (const float y : {kBox.min.y, kBox.max.y})
          for (const float z : {kBox.min.z, kBox.max.z}) {
            const FilmPoint seen = project(camera, {x, y, z});
            EXPECT_GT(seen.distance, 0);
            EXPECT_TRUE(seen.film.x > 0 && seen.film.x < 1 && seen.film.y > 0 && seen.film.y < 1);
          }
    }
}

TEST(Placement, AFlatOrPointlikeSceneIsStillFramed) {
  const Bounds3 point = box({1, 1, 1}, {1, 1, 1});
  Diagnostics diagnostics;
  for (const auto& scene : {scene::SceneDescription{}, scene_with(scene::Camera{}, true)}) {
    const Camera camera = place_camera(scene, point, CameraPlacement::automatic, 800, 600, diagnostics);
    expect_orthonormal_right_handed(camera.to_world);
    EXPECT_GT(length(camera.to_world.origin - Point3(1, 1, 1)), 0.5f);
  }
}

}  // namespace
}  // namespace etendue
