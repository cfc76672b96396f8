// What an opaque surface hides stays hidden, however near it is to a light and however its normals are bent.

#include <gtest/gtest.h>

#include "picture_statistics.h"
#include "render/session.h"
#include "scene_kit.h"

namespace etendue {
namespace {

double brightest(const Picture& picture) {
  float most = 0;
  for (const Spectrum& s : picture.beauty.pixels()) most = std::max(most, s.max());
  return most;
}

RegionMean whole_picture(const Picture& picture) {
  return region_luminance(sampled_picture(picture), [](int, int) { return true; });
}

/// A floor of 20 × 20 m and `distance` above it a lamp, with a black plate just below the lamp that hides it.
TEST(Visibility, APlateJustBelowALampHidesIt) {
  for (const float distance : {1.0f, 100.0f, 1000.0f}) {
    const float gap = 1e-4f * distance;
    SceneKit kit;
    kit.quad({-10, 0, 10}, {20, 0, 0}, {0, 0, -20}, kit.diffuse(Spectrum(0.5f)));
    kit.quad({-1, distance, -1}, {2, 0, 0}, {0, 0, 2}, kit.emitter(Spectrum(100)));
    kit.quad({-3, distance - gap, -3}, {6, 0, 0}, {0, 0, 6}, kit.diffuse(Spectrum(0)));
    const Picture picture = render(kit.compile(), pinhole({0, 0.5f, 2}, {0, 0, 0}, 0.3f), square_settings(16, 16, 1));
    EXPECT_EQ(brightest(picture), 0) << distance;
  }
}

/// The light's own surface is no obstacle, at any scale and angle: a lamp close to a floor that reaches far beyond it.
TEST(Visibility, ALampDoesNotHideItself) {
  for (const float scale : {1e-3f, 1.0f, 1e4f}) {
    SceneKit shadowed;
    shadowed.quad(Point3(-10, 0, 10) * scale, Vec3(20, 0, 0) * scale, Vec3(0, 0, -20) * scale,
                  shadowed.diffuse(Spectrum(1)));
    shadowed.quad(Point3(-1, 0.02f, -1) * scale, Vec3(2, 0, 0) * scale, Vec3(0, 0, 2) * scale,
                  shadowed.emitter(Spectrum(1)));
    const RenderScene scene = shadowed.compile();
    const Camera camera = pinhole(Point3(0, 1, 4) * scale, Point3(0, 0, 1.5f) * scale, 0.3f);
    RenderSettings settings = square_settings(16, 64, 1);
    const double by_light = whole_picture(render(scene, camera, settings)).mean;
    settings.integrator = IntegratorKind::hemisphere;
    settings.light_samples = 64;
    const RegionMean by_direction = whole_picture(render(scene, camera, settings));
    EXPECT_GT(by_direction.p_value(by_light, 5e-3 * by_light), 1e-4) << scale;
  }
}

/// Normals bent by 60° must not let light from behind the true surface through, whichever way direct light is found.
TEST(Visibility, BentNormalsLetNothingThrough) {
  SceneKit kit;
  kit.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, kit.diffuse(Spectrum(0.5f)));
  kit.quad({3, -1, -1}, {0, 0, 2}, {0, 0.9f, 0},
           kit.emitter(Spectrum(10)));  // below the floor, in front of its normals
  scene::SceneDescription description = kit.description();
  description.meshes[0].normals.assign(description.meshes[0].positions.size(), normalize(Vec3(1.7f, 1, 0)));
  Diagnostics diagnostics;
  const RenderScene scene = compile(description, {}, diagnostics);
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::hemisphere}) {
    RenderSettings settings = square_settings(16, 64, 1);
    settings.integrator = kind;
    EXPECT_EQ(brightest(render(scene, pinhole({0.5f, 3, 0}, {0, 0, 0}, 0.2f), settings)), 0);
  }
}

}  // namespace
}  // namespace etendue
