// What light passes straight through (masks, thin glass), and lamps that the camera looks through.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "picture_statistics.h"
#include "scene_kit.h"

namespace etendue {
namespace {

constexpr float kIor = 1.5f;
/// Of light that falls straight onto a pane of glass: 1 − 2R / (1 + R) with R = ((n − 1) / (n + 1))².
constexpr float kPaneTransmittance = 1 - 2 * 0.04f / 1.04f;

enum class Follows { surfaces, media };

/// Media, wherever they are, are another integrator's.
void choose_integrator(SceneKit& kit, Follows follows) {
  if (follows == Follows::media) kit.medium({});
}

double mean(const Image& beauty) {
  return over_pixels(beauty, 1).mean();
}

const std::vector<float>& depths(const Picture& picture) {
  return std::ranges::find(picture.channels, "depth.Z", &Channel::name)->values;
}

/// A grey floor at y = 0 and two metres above it a plate; the camera sees the floor's middle from below the plate.
const Camera kOnFloor = pinhole({0.5f, 1, 0}, {0, 0, 0}, 0.001f);
SceneKit floor_below(const scene::Surface& plate) {
  SceneKit kit;
  kit.quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, kit.diffuse(Spectrum(0.5f)));
  kit.quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, kit.material(plate));
  return kit;
}

RenderSettings settings(bool null_counts_as_bounce, int max_depth, int samples = 4096) {
  RenderSettings settings = square_settings(4, samples, max_depth);
  settings.null_counts_as_bounce = null_counts_as_bounce;
  return settings;
}

scene::ThinGlassMaterial pane() {
  scene::ThinGlassMaterial glass;
  glass.ior = kIor;
  return glass;
}

TEST(StraightThrough, ThinGlassIsNoBounceWhereNullIsNone) {
  for (const Follows follows : {Follows::surfaces, Follows::media}) {
    SceneKit kit;
    kit.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, kit.emitter(Spectrum(3)));
    kit.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, kit.material(pane()));
    choose_integrator(kit, follows);
    const RenderScene scene = kit.compile();
    const Camera camera = pinhole({0, 0, 2}, {0, 0, 0}, 0.001f);
    EXPECT_NEAR(mean(render(scene, camera, settings(false, 0)).beauty), 3 * kPaneTransmittance, 0.02);
    EXPECT_EQ(mean(render(scene, camera, settings(true, 0)).beauty), 0);
    EXPECT_NEAR(mean(render(scene, camera, settings(true, 1)).beauty), 3 * kPaneTransmittance, 0.02);
  }
}

TEST(StraightThrough, PointLightsShineThroughThinGlassWhereNullIsNoBounce) {
  for (const Follows follows : {Follows::surfaces, Follows::media}) {
    SceneKit kit = floor_below(pane());
    kit.light(scene::PointLight{Spectrum(9)}, Transform::translation({0, 3, 0}));
    choose_integrator(kit, follows);
    const RenderScene scene = kit.compile();
    const double unhindered = 0.5 / 3.14159265 * 9 / 9;
    EXPECT_NEAR(mean(render(scene, kOnFloor, settings(false, 1)).beauty), unhindered * kPaneTransmittance, 2e-4);
    EXPECT_EQ(mean(render(scene, kOnFloor, settings(true, 1)).beauty), 0);
  }
}

/// Mitsuba's path tracer finds point lights by shadow rays alone, and to those a mask is as opaque as a wall.
TEST(StraightThrough, MasksHidePointLightsWhereNullIsABounce) {
  for (const Follows follows : {Follows::surfaces, Follows::media}) {
    SceneKit kit = floor_below(scene::NullMaterial{});
    kit.light(scene::PointLight{Spectrum(9)}, Transform::translation({0, 3, 0}));
    choose_integrator(kit, follows);
    const RenderScene scene = kit.compile();
    EXPECT_NEAR(mean(render(scene, kOnFloor, settings(false, 1)).beauty), 0.5 / 3.14159265, 1e-4);
    EXPECT_EQ(mean(render(scene, kOnFloor, settings(true, 5)).beauty), 0);
  }
}

/// However their light is counted, lamps of some size are found by rays that choose their direction, too.
TEST(StraightThrough, LampsShineThroughThinGlassOneWayOrTheOther) {
  std::vector<RunningMean> found;
  for (const Follows follows : {Follows::surfaces, Follows::media})
    for (const bool counts : {true, false}) {
      SceneKit kit = floor_below(pane());
      kit.quad({-0.5f, 3, -0.5f}, {1, 0, 0}, {0, 0, 1}, kit.emitter(Spectrum(20)));
      choose_integrator(kit, follows);
      found.push_back(over_pixels(render(kit.compile(), kOnFloor, settings(counts, 2, 1 << 14)).beauty, 1));
      EXPECT_LT(found.back().standard_error(), 0.003 * found.back().mean());
      EXPECT_GT(found.back().p_value(found.front().mean(), 0.003 * found.front().mean()), 1e-3);
    }
  // A square lamp of 1 m² at a distance of 3 m: 20 · 0.5 / π · form factor of two parallel rectangles, over all four.
  const double x = 0.5 / 3, root = std::sqrt(1 + x * x);
  const double form_factor = 4 / (2 * 3.14159265) * 2 * x / root * std::atan(x / root);
  EXPECT_NEAR(found.front().mean(), 20 * 0.5 * form_factor * kPaneTransmittance, 0.01 * found.front().mean());
}

/// The shapes of two lamps between the camera and a wall are as if cut away.
TEST(HiddenEmitters, AreLookedThrough) {
  for (const Follows follows : {Follows::surfaces, Follows::media}) {
    SceneKit kit;
    kit.quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, kit.diffuse(Spectrum(0.5f)));
    kit.quad({-1, 1, 1}, {2, 0, 0}, {0, -2, 0}, kit.emitter(Spectrum(5)));  // faces the wall
    kit.sphere({0, 0, 2}, 0.3f, kit.emitter(Spectrum(1)));
    kit.light(scene::ConstantLight{Spectrum(0.25f)});
    choose_integrator(kit, follows);
    const RenderScene scene = kit.compile();
    Camera camera = pinhole({0, 0, 4}, {0, 0, 0}, 1);
    RenderSettings settings = square_settings(16, 64);
    settings.hide_emitters = true;
    const Picture looked_through = render(scene, camera, settings);
    camera.near_clip = 3.5f;
    const Picture cut = render(scene, camera, settings);
    for (std::size_t i = 0; i < cut.beauty.pixels().size(); ++i) {
      EXPECT_NEAR(looked_through.beauty.pixels()[i].g, cut.beauty.pixels()[i].g, 1e-4f) << i;
      EXPECT_NEAR(depths(looked_through)[i], depths(cut)[i], 1e-4f) << i;
    }
    EXPECT_GT(mean(cut.beauty), 0.1);
    EXPECT_EQ(looked_through.beauty.at(0, 0), Spectrum(0)) << "the sky is hidden, too";
  }
}

/// Behind a mask they are hidden where passing it is no bounce, as in Mitsuba.
TEST(HiddenEmitters, BehindAMask) {
  for (const Follows follows : {Follows::surfaces, Follows::media}) {
    SceneKit kit;
    kit.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, kit.emitter(Spectrum(3)));
    kit.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, kit.material(scene::NullMaterial{}));
    choose_integrator(kit, follows);
    const Camera camera = pinhole({0, 0, 2}, {0, 0, 0}, 0.001f);
    for (const bool counts : {false, true}) {
      RenderSettings s = settings(counts, 5, 16);
      s.hide_emitters = true;
      EXPECT_EQ(mean(render(kit.compile(), camera, s).beauty), counts ? 3 : 0);
    }
  }
}

}  // namespace
}  // namespace etendue
