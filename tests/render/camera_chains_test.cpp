// Chains of many mirrors and glass walls that are followed beside the camera's paths change noise, not light.

#include <gtest/gtest.h>

#include "picture_statistics.h"
#include "technique_comparison.h"

namespace etendue {
namespace {

const Technique kSplitting{.name = "splitting", .splitting = Use::on};

/// A long box that the camera looks into, with a lamp at its end, `size` times as wide.
Place lamp_behind(MaterialId (*material)(SceneKit&), bool is_open, float size = 0.4f) {
  Place place;
  SceneKit& kit = place.kit;
  const MaterialId walls = material(kit);
  const float w = 0.3f, length = 4;
  kit.quad({-w, -w, 0}, {0, 0, -length}, {2 * w, 0, 0}, walls);
  kit.quad({-w, w, 0}, {2 * w, 0, 0}, {0, 0, -length}, walls);
  kit.quad({-w, -w, 0}, {0, 2 * w, 0}, {0, 0, -length}, walls);
  kit.quad({w, -w, 0}, {0, 0, -length}, {0, 2 * w, 0}, walls);
  if (!is_open) {
    kit.quad({-w, -w, 0}, {2 * w, 0, 0}, {0, 2 * w, 0}, walls);
    kit.quad({-w, -w, -length}, {0, 2 * w, 0}, {2 * w, 0, 0}, walls);
  }
  const float lamp = 2 * w * size;
  kit.quad({-0.55f * lamp, -0.45f * lamp, -length - 0.1f}, {lamp, 0, 0}, {0, lamp, 0}, kit.emitter(Spectrum(10)));
  place.camera = pinhole({0, 0, 0.5f}, {0, 0, -1}, 0.5f);
  return place;
}

Look look_at(int depth = kUnlimitedDepth) {
  return small_look(32, depth);
}

void expect_same(const Place& place, const Look& look) {
  expect_same_means(place, std::span(&kSplitting, 1), look);
}

TEST(CameraChains, Mirrors) {
  expect_same(lamp_behind(mirror, true), look_at());
}
TEST(CameraChains, MirrorsOfAsManyBouncesAsCount) {
  expect_same(lamp_behind(mirror, true), look_at(6));
}
/// Beside its delta lobe such a surface has another, where chains end.
TEST(CameraChains, PolishedPlasticBehindGlass) {
  Place place;
  SceneKit& kit = place.kit;
  const MaterialId panes = glass(kit);
  for (const float z : {0.3f, 0.1f}) {
    kit.quad({-1, -1, z}, {2, 0, 0}, {0, 2, 0}, panes);
    kit.quad({-1, -1, z - 0.05f}, {0, 2, 0}, {2, 0, 0}, panes);
  }
  kit.quad({-2, -0.4f, 0}, {4, 0, 0}, {0, 0, -4},
           kit.material(scene::PlasticMaterial{.diffuse = Spectrum(0.02f), .ior = 4}));
  kit.quad({-1, -0.3f, -3}, {2, 0, 0}, {0, 1, 0}, kit.emitter(Spectrum(10)));
  place.camera = pinhole({0, 0, 0.5f}, {0, -0.4f, -1}, 0.3f);
  expect_same(place, look_at());
}
TEST(CameraChains, Glass) {
  expect_same(lamp_behind(glass, false), look_at());
}
/// Both ways are worth following there: 21 to 35 % are reflected.
TEST(CameraChains, GlassAtAGlance) {
  Place place;
  SceneKit& kit = place.kit;
  const MaterialId pane = glass(kit);
  kit.quad({-3, 0, 1}, {6, 0, 0}, {0, 0, -6}, pane);
  kit.quad({-3, -0.1f, 1}, {0, 0, -6}, {6, 0, 0}, pane);
  kit.quad({-1, 0.1f, -3}, {2, 0, 0}, {0, 1, 0}, kit.emitter(Spectrum(10)));
  place.camera = pinhole({0, 0.3f, 0.5f}, {0, -0.27f, -1}, 0.1f);
  expect_same(place, look_at());
}
TEST(CameraChains, ThroughALens) {
  Place place = lamp_behind(glass, false);
  place.camera.lens_radius = 0.05f;
  place.camera.focal_distance = 3;
  expect_same(place, look_at());
}

RenderSettings few_samples(Use splitting, std::uint64_t seed) {
  RenderSettings settings = with({.name = "", .splitting = splitting}, square_settings(64, 8));
  settings.seed = seed;
  return settings;
}

/// Mean squared difference of two pictures that differ by their random numbers alone, at both sides, where all chains
/// are long.
double noise(const Place& place, Use splitting) {
  const RenderScene scene = place.kit.compile();
  const Image a = render(scene, place.camera, few_samples(splitting, 1)).beauty;
  const Image b = render(scene, place.camera, few_samples(splitting, 2)).beauty;
  RunningMean squares;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x)
      if (x < 6 || x >= a.width() - 6) squares.add(square(a.at(x, y).g - b.at(x, y).g));
  return squares.mean();
}

TEST(CameraChains, AreLessNoisyForMoreOfThem) {
  Place place = lamp_behind(mirror, true, 0.05f);
  place.camera = pinhole({0, 0, 0.1f}, {0, 0, -1}, 1);
  EXPECT_LT(4 * noise(place, Use::on), noise(place, Use::off));
}

/// A lamp before the camera that is not to be seen does not end them.
TEST(CameraChains, LookBehindHiddenLamps) {
  const auto mean = [](const Place& place) {
    RenderSettings settings = few_samples(Use::on, 1);
    settings.hide_emitters = true;
    const Image image = render(place.kit.compile(), place.camera, settings).beauty;
    RunningMean light;
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) light.add(image.at(x, y).g);
    return light.mean();
  };
  const Place seen = lamp_behind(mirror, true);
  Place hidden = lamp_behind(mirror, true);
  hidden.kit.quad({-1, -1, 0.2f}, {2, 0, 0}, {0, 2, 0}, hidden.kit.emitter(Spectrum(1)));
  EXPECT_GT(mean(seen), 0);
  EXPECT_NEAR(mean(hidden) / mean(seen), 1, 0.002);
}

}  // namespace
}  // namespace etendue
