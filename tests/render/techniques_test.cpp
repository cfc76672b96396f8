// Photons and shared paths change how noisy a picture is, not what it shows: their means are those of plain path
// tracing. Pixels of such pictures know of each other, so seeds are what is compared.

#include <gtest/gtest.h>

#include "base/tests/temporary_folder.h"
#include "technique_comparison.h"

namespace etendue {
namespace {

constexpr int kSide = 32;
/// Photons reach as far as pixels are wide: of a picture of this width a small part is looked at.
constexpr int kWholeSide = 512;

Camera looking_down(float height, float half) {
  return pinhole({0.02f, height, 0.03f}, {0, 0, 0}, half);
}

/// A grey floor with a light above, and on the way from it what is put there.
void floor_and_lamp(SceneKit& kit, float lamp, float radiance) {
  kit.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, kit.diffuse({0.7f, 0.5f, 0.3f}));
  kit.quad({-lamp, 3, -lamp}, {2 * lamp, 0, 0}, {0, 0, 2 * lamp}, kit.emitter(Spectrum(radiance)));
}

Place glass_ball() {
  Place place;
  floor_and_lamp(place.kit, 1, 2);
  place.kit.sphere({0, 1, 0}, 0.4f, glass(place.kit));
  place.camera = looking_down(0.5f, 9);
  return place;
}

/// Mirrors and glass of triangles, lit by a ball.
Place polished_things() {
  Place place;
  place.kit.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, place.kit.diffuse({0.7f, 0.5f, 0.3f}));
  place.kit.sphere({0, 2.8f, 1}, 0.7f, place.kit.emitter(Spectrum(4)));
  place.kit.quad({-1, 0.2f, -1.2f}, {2, 0, 0}, {0, 1, 0.2f}, mirror(place.kit));
  place.kit.triangulated_sphere({0.2f, 1, 0.3f}, 0.3f, 6, glass(place.kit));
  place.camera = looking_down(0.6f, 9);
  return place;
}

/// A lens whose interpolated normals bend light as its facets do not: étendue is not kept there.
Place faceted_lens() {
  Place place;
  floor_and_lamp(place.kit, 2, 0.6f);
  std::vector<Point3> positions;
  std::vector<Vec3> normals;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  constexpr int kN = 6;
  for (int i = 0; i <= kN; ++i)
    for (int j = 0; j <= kN; ++j) {
      const float x = 2.0f * static_cast<float>(i) / kN - 1, z = 2.0f * static_cast<float>(j) / kN - 1;
      positions.push_back({x * 0.6f, 1, z * 0.6f});
      normals.push_back(normalize(Vec3(0.5f * x, 1, 0.5f * z)));
    }
  const auto at = [](int i, int j) { return static_cast<std::uint32_t>(i * (kN + 1) + j); };
  for (int i = 0; i < kN; ++i)
    for (int j = 0; j < kN; ++j) {
      triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
      triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  place.kit.mesh(positions, triangles, glass(place.kit), normals);
  place.camera = looking_down(0.5f, 9);
  return place;
}

/// A floor under a map with a bright spot.
Place sky_and_floor(const TemporaryFolder& folder) {
  Place place;
  Image map(16, 9, Spectrum(0.5f));
  map.at(5, 2) = Spectrum(60, 50, 40);
  place.kit.light(environment_map(folder / "sky.exr", map));
  place.kit.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, place.kit.diffuse({0.7f, 0.5f, 0.3f}));
  place.camera = looking_down(0.25f, 9);
  return place;
}

Place glass_under_the_sky(const TemporaryFolder& folder) {
  Place place = sky_and_floor(folder);
  place.kit.sphere({0, 0.8f, 0}, 0.5f, glass(place.kit));
  return place;
}

/// Light that goes round a corner, off smooth-shaded and glossy things.
Place corridor() {
  Place place;
  SceneKit& kit = place.kit;
  const MaterialId wall = kit.diffuse({0.8f, 0.6f, 0.4f});
  kit.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, wall);
  kit.quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, wall);
  kit.quad({-1, 0, -1}, {2, 0, 0}, {0, 1, 0}, wall);
  kit.quad({1, 0, -1}, {0, 0, 2}, {0, 1, 0}, wall);
  kit.quad({-1, 0, 1}, {0, 0, -2}, {0, 1, 0}, wall);
  kit.quad({0, 0, -0.2f}, {0, 0, 0.9f}, {0, 0.8f, 0}, wall);
  scene::PlasticMaterial glossy;
  glossy.diffuse = Spectrum(0.5f);
  glossy.alpha = 0.2f;
  const MaterialId plastic = kit.material(glossy);
  kit.sphere({-0.6f, 0.25f, 0.2f}, 0.25f, plastic);
  kit.triangulated_sphere({-0.5f, 0.2f, -0.5f}, 0.2f, 8, wall);
  kit.quad({0.2f, 0.99f, -0.8f}, {0.7f, 0, 0}, {0, 0, 1.5f}, kit.emitter(Spectrum(3)));
  place.camera = pinhole({-0.9f, 0.5f, 0.9f}, {-0.4f, 0.3f, -0.3f}, 0.9f);
  return place;
}

/// Under the same sky, metal of some roughness.
Place metal_under_the_sky(const TemporaryFolder& folder, float alpha) {
  Place place = sky_and_floor(folder);
  place.kit.sphere({0, 0.9f, 0}, 0.5f, steel(place.kit, alpha));
  return place;
}

/// Precise enough to see an error of 1 % of the whole, and of a few per cent of a quarter.
void expect_same_means(const Place& place, const Technique& technique, int whole_side, int depth = kUnlimitedDepth,
                       int samples = 256) {
  Look look;
  look.whole_side = whole_side;
  look.side = kSide;
  look.depth = depth;
  look.plain_samples = 512;
  look.samples = samples;
  look.seeds = 16;
  // What photons blur across the border of the part that is looked at.
  look.blur = technique.photons == Use::on ? 0.005 : 0;
  expect_same_means(place, std::span(&technique, 1), look);
}

const Technique kPhotons{"photons", IntegratorKind::path, Use::on};
const Technique kReuse{"reuse", IntegratorKind::path, Use::off, Use::on};
const Technique kBoth{"both", IntegratorKind::path, Use::on, Use::on, Use::off, SamplerKind::independent};

TEST(Techniques, PhotonsThroughAGlassBall) {
  expect_same_means(glass_ball(), kPhotons, kWholeSide);
}
TEST(Techniques, PhotonsOfLimitedDepth) {
  expect_same_means(glass_ball(), kPhotons, kWholeSide, 3);
}
TEST(Techniques, PhotonsFromMirrorsAndFacets) {
  expect_same_means(polished_things(), kPhotons, kWholeSide);
}
TEST(Techniques, PhotonsThroughInterpolatedNormals) {
  expect_same_means(faceted_lens(), kPhotons, kWholeSide);
}
TEST(Techniques, PhotonsFromTheSky) {
  const TemporaryFolder folder;
  expect_same_means(glass_under_the_sky(folder), kPhotons, kWholeSide);
}
TEST(Techniques, PhotonsOffRoughMetal) {
  const TemporaryFolder folder;
  // Few photons of the sky's meet the ball, and so many are sent: a generation takes long, and few are needed.
  expect_same_means(metal_under_the_sky(folder, 0.1f), kPhotons, kWholeSide, kUnlimitedDepth, 64);
  expect_same_means(metal_under_the_sky(folder, 0.35f), kPhotons, kWholeSide, 3, 64);
}
TEST(Techniques, SharedPathsRoundACorner) {
  expect_same_means(corridor(), kReuse, kSide);
}
TEST(Techniques, SharedPathsOfLimitedDepth) {
  expect_same_means(corridor(), kReuse, kSide, 2);
}
TEST(Techniques, BothTogether) {
  expect_same_means(glass_ball(), kBoth, kWholeSide);
  expect_same_means(polished_things(), kBoth, kWholeSide);
}

}  // namespace
}  // namespace etendue
