// What the camera's paths do at glass and at things that gleam changes noise, not light: they go both ways at the one
// and look for lights in several directions at the other. And light that goes by way of glass and mirrors twice.

#include <gtest/gtest.h>

#include "technique_comparison.h"

namespace etendue {
namespace {

const Spectrum kPaint{0.7f, 0.6f, 0.5f};
const Technique kBranches{"branches and looks", IntegratorKind::automatic};
const Technique kForced[] = {{.name = "splitting on", .splitting = Use::on},
                             {.name = "off", .integrator = IntegratorKind::automatic, .splitting = Use::off}};
const Technique kPhotons{"photons", IntegratorKind::path, Use::on};

/// A small lamp mirrored in a ball and a slab of glass, through both of which a floor is seen.
Place lamp_in_glass() {
  Place place;
  SceneKit& kit = place.kit;
  kit.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, kit.diffuse(kPaint));
  kit.quad({0.1f, 2, -0.8f}, {0.9f, 0, 0}, {0, 0, 0.9f}, kit.emitter(Spectrum(6)));
  kit.sphere({-0.4f, 0.5f, 0}, 0.45f, glass(kit));
  kit.quad({0.1f, 0.4f, 0.6f}, {0.9f, 0, 0}, {0, 0, -1.2f}, glass(kit));
  kit.quad({0.1f, 0.3f, -0.6f}, {0.9f, 0, 0}, {0, 0, 1.2f}, glass(kit));
  place.camera = pinhole({0, 1.6f, 1.6f}, {0, 0.3f, 0}, 0.35f);
  return place;
}

/// Lamps of several sizes over metal.
Place metal(float alpha) {
  Place place;
  SceneKit& kit = place.kit;
  kit.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, steel(kit, alpha));
  kit.quad({-2, 0, -1.5f}, {4, 0, 0}, {0, 2, 0}, kit.diffuse(kPaint));
  kit.sphere({-0.7f, 0.8f, -0.8f}, 0.03f, kit.emitter(Spectrum(300)));
  kit.sphere({0, 0.8f, -0.8f}, 0.12f, kit.emitter(Spectrum(20)));
  kit.sphere({0.9f, 1, -0.8f}, 0.5f, kit.emitter(Spectrum(1.5f)));
  place.camera = pinhole({0, 1, 1.5f}, {0, 0, -0.1f}, 0.45f);
  return place;
}

/// Two lights, which are both asked, over metal and paint.
Place lamp_and_sky() {
  Place place;
  SceneKit& kit = place.kit;
  kit.light(scene::ConstantLight{{0.3f, 0.4f, 0.6f}});
  kit.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, steel(kit, 0.2f));
  kit.quad({-2, 0, -1}, {4, 0, 0}, {0, 0.7f, 0}, kit.diffuse(kPaint));
  kit.sphere({0.2f, 0.8f, -0.5f}, 0.15f, kit.emitter(Spectrum(20)));
  place.camera = pinhole({0, 1, 1.5f}, {0, 0.1f, -0.3f}, 0.45f);
  return place;
}

/// A wide lamp above a pane of glass lights a wall, and the wall, by way of a mirror, the floor under a board.
Place glass_wall_mirror_floor() {
  Place place;
  SceneKit& kit = place.kit;
  const MaterialId paint = kit.diffuse(kPaint);
  kit.quad({-1.5f, 0, 1.5f}, {3, 0, 0}, {0, 0, -3}, paint);
  kit.quad({-1.5f, 0, -1.5f}, {3, 0, 0}, {0, 2.4f, 0}, paint);
  kit.quad({-1.5f, 2.4f, -1.5f}, {3, 0, 0}, {0, 0, 3}, kit.emitter(Spectrum(2)));
  kit.quad({-1.6f, 2.2f, 1.6f}, {3.2f, 0, 0}, {0, 0, -3.2f}, glass(kit));
  kit.quad({-1.6f, 2.1f, -1.6f}, {3.2f, 0, 0}, {0, 0, 3.2f}, glass(kit));
  kit.quad({-1.5f, 0.1f, 1}, {0, 1.8f, 0.4f}, {3, 0, 0}, mirror(kit));
  kit.quad({-1, 1.2f, -0.8f}, {2, 0, 0}, {0, 0, 1.6f}, paint);
  place.camera = pinhole({0, 0.9f, 0.6f}, {0, 0, -0.2f}, 0.4f);
  return place;
}

Look look_at(int depth = kUnlimitedDepth) {
  return small_look(64, depth);
}

void expect_same(const Place& place, const Technique& technique, const Look& look) {
  expect_same_means(place, std::span(&technique, 1), look);
}

TEST(Branches, LampInGlass) {
  expect_same(lamp_in_glass(), kBranches, look_at());
}
TEST(Branches, AreForcedOnAndOff) {
  expect_same_means(lamp_in_glass(), kForced, look_at());
  expect_same_means(metal(0.3f), kForced, look_at(1));
}
TEST(Branches, LampInGlassOfLimitedDepth) {
  expect_same(lamp_in_glass(), kBranches, look_at(3));
}
TEST(Branches, LampsOverPolishedMetal) {
  expect_same(metal(0.03f), kBranches, look_at());
}
TEST(Branches, LampsOverRoughMetal) {
  expect_same(metal(0.3f), kBranches, look_at());
}
TEST(Branches, LampAndSky) {
  expect_same(lamp_and_sky(), kBranches, look_at());
}
TEST(Chains, GlassWallMirrorFloor) {
  Look look = look_at();
  look.whole_side = 256;
  look.side = 128;
  look.plain_samples = 24;
  look.samples = 80;
  look.quarter_error = 0.02;  // two of them are dark
  look.blur = 0.005;
  expect_same(glass_wall_mirror_floor(), kPhotons, look);
}

}  // namespace
}  // namespace etendue
