// Two ways to the same picture.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "camera/placement.h"
#include "formats/formats.h"
#include "picture_statistics.h"
#include "scene_kit.h"

namespace etendue {
namespace {

struct Stage {
  RenderScene scene;
  Camera camera;
};

constexpr int kSize = 48;

Stage cornell_spheres() {
  Diagnostics diagnostics;
  const scene::SceneDescription description = read_scene(SCENES_FOLDER "/cornell-spheres.dae", diagnostics);
  RenderScene scene = compile(description, {}, diagnostics);
  const Camera camera =
      place_camera(description, scene.bounds(), CameraPlacement::automatic, kSize, kSize, diagnostics);
  return {std::move(scene), camera};
}

/// In blocks of 4 × 4 pixels, since caustics and fireflies are no matter for a single pixel's normal distribution.
void expect_agreement(const SampledPicture& a, const SampledPicture& b) {
  const BlockComparison comparison = compare_in_blocks(a, b, 4);
  EXPECT_GE(comparison.agreeing_share, kAgreeingShare);
  EXPECT_LT(comparison.rms_z, 1.15);  // 1 ± 3 · 1/√(2 · 432) if all were normal and independent
  for (int c = 0; c < 3; ++c) {
    const CropWindow all{0, 0, a.mean.width(), a.mean.height()};
    EXPECT_GT(region_mean(a, all, c).p_value(region_mean(b, all, c)), sidak(0.01, 3)) << "channel " << c;
  }
}

TEST(CrossCheck, SobolAndIndependentSamplesGiveTheSamePicture) {
  const Stage stage = cornell_spheres();
  RenderSettings settings = square_settings(kSize, 256);
  const SampledPicture independent = sampled_picture(render(stage.scene, stage.camera, settings));
  settings.sampler = SamplerKind::sobol;
  expect_agreement(sampled_picture(render(stage.scene, stage.camera, settings)), independent);
}

TEST(CrossCheck, LightsMayBeSampledOnceOftenOrNotAtAll) {
  const Stage stage = cornell_spheres();
  RenderSettings settings = square_settings(kSize, 256);
  const SampledPicture one_light = sampled_picture(render(stage.scene, stage.camera, settings));
  for (const int light_samples : {1, 4}) {
    RenderSettings other = settings;
    other.samples_per_pixel = 128;
    other.light_samples = light_samples;
    other.seed = 5;
    expect_agreement(one_light, sampled_picture(render(stage.scene, stage.camera, other)));
  }
  settings.integrator = IntegratorKind::hemisphere;
  settings.light_samples = 4;
  expect_agreement(one_light, sampled_picture(render(stage.scene, stage.camera, settings)));
}

TEST(CrossCheck, DirectIsPathToDepthOne) {
  const Stage stage = cornell_spheres();
  RenderSettings settings = square_settings(kSize, 32, 1);
  const Picture path = render(stage.scene, stage.camera, settings);
  settings.integrator = IntegratorKind::direct;
  settings.max_depth = 7;
  EXPECT_TRUE(identical(path, render(stage.scene, stage.camera, settings)));
}

/// Diffuse and metal things under a light that `add_light` makes.
SampledPicture under(const std::function<void(SceneKit&)>& add_light, int light_samples, std::uint64_t seed) {
  SceneKit kit;
  kit.quad({-4, -1, 4}, {8, 0, 0}, {0, 0, -8}, kit.diffuse(Spectrum(0.5f, 0.4f, 0.3f)));
  kit.sphere({-1.1f, 0, 0}, 1, kit.diffuse(Spectrum(0.7f)));
  kit.sphere({1.1f, 0, 0}, 1,
             kit.material(scene::ConductorMaterial{Spectrum(0.2f), Spectrum(3), 0.15f, 0.15f, scene::Microfacets::ggx,
                                                   Spectrum(1)}));
  add_light(kit);
  RenderSettings settings = square_settings(kSize, 128, 3);
  settings.light_samples = light_samples;
  settings.seed = seed;
  return sampled_picture(render(kit.compile(), pinhole({0, 1.5f, 6}, {0, 0.4f, 0}, 0.45f), settings));
}

TEST(CrossCheck, AMeshOfManyTrianglesShinesLikeTheRectangleItFills) {
  const Point3 corner(-1.5f, 1.7f, -1.5f);
  const Vec3 edge_x(1.2f, 0.3f, 0), edge_z(0, 0, 2);
  const auto rectangle = [&](SceneKit& kit) { kit.quad(corner, edge_x, edge_z, kit.emitter(Spectrum(6, 5, 4))); };
  const auto mesh = [&](SceneKit& kit) { kit.quad_grid(corner, edge_x, edge_z, 9, kit.emitter(Spectrum(6, 5, 4))); };
  for (const int light_samples : {0, 3})
    expect_agreement(under(rectangle, light_samples, 1), under(mesh, light_samples, 2));
}

TEST(CrossCheck, AFinelyTriangulatedSphereShinesLikeTheSphere) {
  const Point3 center(-0.2f, 2.1f, 1);
  const auto sphere = [&](SceneKit& kit) { kit.sphere(center, 0.4f, kit.emitter(Spectrum(9))); };
  // Its shape falls short by (π/2n)²: a tenth of a thousandth with 150 rings.
  const auto mesh = [&](SceneKit& kit) { kit.triangulated_sphere(center, 0.4f, 150, kit.emitter(Spectrum(9))); };
  expect_agreement(under(sphere, 0, 1), under(mesh, 4, 2));
}

TEST(CrossCheck, ARectangleLightIsTheQuadOfItsShape) {
  Transform place = Transform::look_at({-0.5f, 2, 0.5f}, {0.3f, 0, 0}, {0, 0, 1});
  place.x *= 1.4f;
  place.y *= 0.8f;
  const auto light = [&](SceneKit& kit) { kit.light(scene::RectangleLight{Spectrum(8)}, place); };
  const auto quad = [&](SceneKit& kit) {  // front along −z: edges turn from y to x
    kit.quad(place.point({-0.5f, -0.5f, 0}), place.y, place.x, kit.emitter(Spectrum(8)));
  };
  expect_agreement(under(light, 0, 1), under(quad, 0, 2));
}

}  // namespace
}  // namespace etendue
