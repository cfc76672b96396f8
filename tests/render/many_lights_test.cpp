// Lights chosen where a vertex stands give the same picture as all of them asked everywhere.

#include <gtest/gtest.h>

#include "picture_statistics.h"
#include "render/session.h"
#include "scene_kit.h"

namespace etendue {
namespace {

/// A room with a chain of small emitters of all brightnesses, shining triangles and a dim sky.
SceneKit room() {
  SceneKit kit;
  kit.quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, kit.diffuse(Spectrum(0.5f, 0.4f, 0.3f)));
  kit.quad({-4, 0, -4}, {8, 0, 0}, {0, 5, 0}, kit.diffuse(Spectrum(0.6f)));
  kit.sphere({-1.2f, 0.8f, 0}, 0.8f, kit.diffuse(Spectrum(0.7f)));
  kit.sphere({1.2f, 0.8f, 0}, 0.8f,
             kit.material(scene::ConductorMaterial{Spectrum(0.2f, 0.92f, 1.1f), Spectrum(3.9f, 2.45f, 2.14f), 0.2f,
                                                   0.2f, scene::Microfacets::beckmann, Spectrum(1)}));
  for (int i = 0; i < 30; ++i) {
    const float x = -3.6f + 0.25f * static_cast<float>(i), power = static_cast<float>(1 << (i % 6));
    kit.sphere({x, 1 + 0.4f * static_cast<float>(i % 5), -3.5f + 0.2f * static_cast<float>(i % 7)}, 0.05f,
               kit.emitter(Spectrum(power, 2, 0.5f * power)));
  }
  kit.quad_grid({-1, 4, -1}, {2, 0, 0}, {0, 0, 2}, 6, kit.emitter(Spectrum(2, 2.5f, 3)));
  kit.triangulated_sphere({2.5f, 0.3f, 2}, 0.3f, 6, kit.emitter(Spectrum(4, 3, 1)));
  kit.light(scene::ConstantLight{Spectrum(0.05f, 0.08f, 0.1f)});
  return kit;
}

/// Lights of no size. In fog, single samples of them have no bound.
void add_lamps(SceneKit& kit) {
  for (int i = 0; i < 8; ++i) {
    const Transform above = Transform::look_at({static_cast<float>(i) - 3.5f, 3, 1}, {0, 0, 0}, {0, 0, 1});
    kit.light(scene::SpotLight{Spectrum(3), 25, 2}, above);
    kit.light(scene::PointLight{Spectrum(0.2f * static_cast<float>(i + 1))}, above);
  }
}

const Camera kIntoRoom = pinhole({0, 2, 7}, {0, 1, 0}, 0.45f);

/// `samples` of every light a pixel, and eight times as many of chosen ones.
void expect_same_picture(const SceneKit& kit, int size, int samples, const CompileOptions& options = {}) {
  const RenderScene scene = kit.compile(options);
  const SampledPicture chosen = sampled_picture(render(scene, kIntoRoom, square_settings(size, 8 * samples, 3)));
  RenderSettings all = square_settings(size, samples, 3);
  all.light_samples = 1;
  const SampledPicture every = sampled_picture(render(scene, kIntoRoom, all));
  const WelchTest pixels = welch_test(chosen, every);
  EXPECT_GE(pixels.agreeing_share, kAgreeingShare);
  EXPECT_LT(pixels.rms_t, 1.1);
  for (int c = 0; c < 3; ++c)
    EXPECT_GT(normal_p(pixels.mean_difference_sigmas[c]), sidak(0.01, 3)) << "of the whole picture, channel " << c;
  const RegionMean a = region_mean(chosen, {0, 0, size, size}, 1), b = region_mean(every, {0, 0, size, size}, 1);
  EXPECT_LT(a.error + b.error, 0.01 * a.mean);
}

TEST(ManyLights, ChoosingOneAgreesWithAskingAll) {
  SceneKit kit = room();
  add_lamps(kit);
  expect_same_picture(kit, 32, 160);
}

TEST(ManyLights, ChoosingOneByPowerAgreesWithAskingAll) {
  SceneKit kit = room();
  add_lamps(kit);
  CompileOptions options;
  options.light_tree = false;
  expect_same_picture(kit, 32, 160, options);
}

TEST(ManyLights, ChoosingOneAgreesWithAskingAllInFog) {
  SceneKit kit = room();
  kit.sphere({0, 2, 0}, 9, kit.material(scene::NullMaterial{}));
  scene::Medium fog;
  fog.sigma_t = Spectrum(0.1f);
  const auto medium = kit.medium(fog);
  kit.fill_last(medium);
  kit.camera_in(medium);
  expect_same_picture(kit, 12, 1000);
}

}  // namespace
}  // namespace etendue
