// Light between diffuse surfaces is the same, looked up or followed.

#include <gtest/gtest.h>

#include "technique_comparison.h"

namespace etendue {
namespace {

const Spectrum kPaint{0.8f, 0.6f, 0.4f};

/// All light but the lamp's own has bounced off the ceiling first.
Place indirect_room() {
  Place place;
  room(place.kit, {-1, 0, -1}, {1, 2, 1}, place.kit.diffuse(kPaint));
  place.kit.quad({-0.4f, 1.7f, 0.4f}, {0.8f, 0, 0}, {0, 0, -0.8f}, place.kit.emitter(Spectrum(10)));
  place.camera = pinhole({0.05f, 0.9f, 0.95f}, {0.1f, 0.5f, -0.6f}, 0.9f);
  return place;
}

/// The half that is seen gets its light over a wall without thickness.
Place dark_half() {
  Place place;
  SceneKit& kit = place.kit;
  const MaterialId paint = kit.diffuse(kPaint);
  room(kit, {-1, 0, -1}, {1, 2, 1}, paint);
  kit.quad({0.1f, 0, -1}, {0, 0, 2}, {0, 1.2f, 0}, paint);
  kit.quad({0.3f, 0.9f, 0.4f}, {0, 0, -0.8f}, {0.4f, 0, 0}, kit.emitter(Spectrum(20)));
  place.camera = pinhole({-0.9f, 0.8f, 0.8f}, {0.1f, 0.4f, -0.5f}, 0.8f);
  return place;
}

/// Wide lamps, and corners that are near: where lights are sampled and where they are met by chance count alike.
Place bright_corners() {
  Place place;
  SceneKit& kit = place.kit;
  const MaterialId paint = kit.diffuse(kPaint);
  room(kit, {-1, 0, -1}, {1, 2, 1}, paint);
  kit.quad({-0.95f, 1.9f, -0.95f}, {1.9f, 0, 0}, {0, 0, 1.9f}, kit.emitter(Spectrum(1)));
  for (int i = 0; i < 8; ++i)
    kit.quad({-0.9f + 0.22f * static_cast<float>(i), 0, -0.8f}, {0.02f, 0.25f, 0}, {0, 0, 1.6f}, paint);
  place.camera = pinhole({0.05f, 0.9f, 0.95f}, {0.1f, 0.1f, -0.3f}, 0.9f);
  return place;
}

/// The room is seen in glass only.
Place room_in_glass() {
  Place place;
  SceneKit& kit = place.kit;
  room(kit, {-1, 0, -1}, {1, 2, 1}, kit.diffuse(kPaint));
  kit.quad({-0.9f, 1.9f, -0.9f}, {1.8f, 0, 0}, {0, 0, 1.8f}, kit.emitter(Spectrum(1)));
  kit.quad({-1, 0, 0.1f}, {2, 0, 0}, {0, 1.2f, -0.9f}, glass(kit));
  place.camera = pinhole({0.05f, 1.2f, 0.6f}, {0, 0.6f, -0.2f}, 0.5f);
  return place;
}

/// A foggy room that glows on all sides, more on one, with a screen across and a mirror in it.
Place foggy_room(const scene::Phase& phase) {
  Place place;
  SceneKit& kit = place.kit;
  scene::Medium fog;
  fog.sigma_t = Spectrum{0.6f, 0.8f, 1.0f};
  fog.albedo = Spectrum{0.9f, 0.8f, 0.7f};
  fog.phase = phase;
  const auto medium = kit.medium(fog);
  const MaterialId paint = kit.diffuse(kPaint);
  room(kit, {-1, 0, -1}, {1, 2, 1}, kit.emitter({0.2f, 0.3f, 0.4f}));
  kit.quad({-0.99f, 0, 1}, {0, 0, -2}, {0, 2, 0}, kit.emitter({1.5f, 1.2f, 0.9f}));
  kit.quad({0.1f, 0, -0.5f}, {0, 0, 0.8f}, {0, 0.8f, 0}, paint);
  kit.quad({-1, 0.01f, 1}, {2, 0, 0}, {0, 0, -2}, paint);
  kit.quad({-0.9f, 0.1f, -0.9f}, {0.5f, 0, -0.05f}, {0, 0.9f, 0.05f}, mirror(kit));
  place.camera = pinhole({0.05f, 0.9f, 0.95f}, {0.1f, 0.7f, -0.6f}, 0.9f);
  kit.camera_in(medium);
  return place;
}

const Technique kTechniques[] = {
    {"cache", IntegratorKind::path, Use::off, Use::off, Use::on},
    {"all", IntegratorKind::automatic, Use::off, Use::on, Use::on, SamplerKind::independent},
};

/// The first two generations, whose cells are widest. In pictures of 128 pixels they are so wide that their blur shows:
/// up to 1.5 % of a quarter.
void expect_same(const Place& place, int depth = kUnlimitedDepth, int side = 64) {
  Look look;
  look.whole_side = 256;
  look.side = side;
  look.depth = depth;
  look.plain_samples = 64;
  look.samples = 32;
  expect_same_means(place, kTechniques, look);
}

/// The whole picture: close to the camera a cell is as wide as all that it sees. Over the quarters' borders cells carry
/// up to 0.5 % of their light.
void expect_same_in_fog(const scene::Phase& phase, int depth = kUnlimitedDepth) {
  Look look;
  look.whole_side = look.side = 96;
  look.depth = depth;
  look.plain_samples = 16;
  look.samples = 32;
  look.seeds = 12;
  look.blur = 0.006;
  expect_same_means(foggy_room(phase), kTechniques, look);
}

TEST(IndirectLight, OffTheCeiling) {
  expect_same(indirect_room());
}
TEST(IndirectLight, OfThreeBounces) {
  expect_same(indirect_room(), 3);
}
TEST(IndirectLight, OfFourBounces) {
  expect_same(indirect_room(), 4);
}
TEST(IndirectLight, DoesNotLeak) {
  expect_same(dark_half(), kUnlimitedDepth, 128);
}
TEST(IndirectLight, InCorners) {
  expect_same(bright_corners());
}
TEST(IndirectLight, InFog) {
  expect_same_in_fog(scene::IsotropicPhase{});
}
TEST(IndirectLight, InFogOfThreeBounces) {
  expect_same_in_fog(scene::IsotropicPhase{}, 3);
}
TEST(IndirectLight, InFogThatScattersForward) {
  expect_same_in_fog(scene::HenyeyGreensteinPhase{0.6f});
}
TEST(IndirectLight, InGlass) {
  expect_same(room_in_glass(), kUnlimitedDepth, 128);
}

}  // namespace
}  // namespace etendue
