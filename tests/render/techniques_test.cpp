// Photons and shared paths change how noisy a picture is, not what it shows: their means are those of plain path
// tracing. Pixels of such pictures know of each other, so seeds are what is compared.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "base/tests/temporary_folder.h"
#include "picture_statistics.h"
#include "scene_kit.h"

namespace etendue {
namespace {

constexpr int kSide = 32;
/// Photons reach as far as pixels are wide: of a picture of this width a small part is looked at.
constexpr int kWholeSide = 512;

struct Place {
  SceneKit kit;
  Camera camera;
};

Camera looking_down(float height, float half) {
  return pinhole({0.02f, height, 0.03f}, {0, 0, 0}, half);
}

/// A grey floor with a light above, and on the way from it what is put there.
void floor_and_lamp(SceneKit& kit, float lamp, float radiance) {
  kit.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, kit.diffuse({0.7f, 0.5f, 0.3f}));
  kit.quad({-lamp, 3, -lamp}, {2 * lamp, 0, 0}, {0, 0, 2 * lamp}, kit.emitter(Spectrum(radiance)));
}

MaterialId glass(SceneKit& kit) {
  return kit.material(scene::GlassMaterial{Spectrum(1), {0.9f, 1, 0.8f}, 1.5f});
}
MaterialId mirror(SceneKit& kit) {
  return kit.material(scene::MirrorMaterial{{0.9f, 0.8f, 0.7f}});
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

/// Glass under a map with a bright spot.
Place glass_under_the_sky(const TemporaryFolder& folder) {
  Place place;
  Image map(16, 9, Spectrum(0.5f));
  map.at(5, 2) = Spectrum(60, 50, 40);
  place.kit.light(environment_map(folder / "sky.exr", map));
  place.kit.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, place.kit.diffuse({0.7f, 0.5f, 0.3f}));
  place.kit.sphere({0, 0.8f, 0}, 0.5f, glass(place.kit));
  place.camera = looking_down(0.25f, 9);
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

/// Means over the quarters of a picture and over all of it (the fifth), of several seeds.
struct SeedMeans {
  RunningMean part[5][3];
};

SeedMeans means_of(const Place& place, const RenderScene& scene, RenderSettings settings, int seeds) {
  SeedMeans means;
  for (int seed = 1; seed <= seeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const Image image = render(scene, place.camera, settings).beauty;
    Spectrum sums[5];
    for (int q = 0; q < 4; ++q) {
      Spectrum sum;
      for (int y = 0; y < kSide / 2; ++y)
        for (int x = 0; x < kSide / 2; ++x) sum += image.at(x + q % 2 * (kSide / 2), y + q / 2 * (kSide / 2));
      sums[q] = sum * (4.0f / (kSide * kSide));
      sums[4] += sums[q] * 0.25f;
    }
    for (int q = 0; q < 5; ++q)
      for (int c = 0; c < 3; ++c) means.part[q][c].add(sums[q][c]);
  }
  return means;
}

struct Technique {
  std::string name;
  Use photons, reuse;
  SamplerKind sampler = SamplerKind::sobol;
};

/// Precise enough to see an error of 1 % of the whole, and of a few per cent of a quarter.
void expect_same_means(const Place& place, const Technique& technique, int whole_side, int depth = kUnlimitedDepth) {
  SCOPED_TRACE(technique.name);
  const RenderScene scene = place.kit.compile();
  RenderSettings settings;
  settings.width = settings.height = whole_side;
  settings.crop = CropWindow{(whole_side - kSide) / 2, (whole_side - kSide) / 2, kSide, kSide};
  settings.max_depth = depth;
  settings.integrator = IntegratorKind::path;
  settings.sampler = technique.sampler;
  settings.samples_per_pixel = 512;
  const SeedMeans plain = means_of(place, scene, settings, 16);
  settings.photons = technique.photons;
  settings.reuse = technique.reuse;
  settings.samples_per_pixel = 256;
  const SeedMeans other = means_of(place, scene, settings, 16);
  // What photons blur across the border of the part that is looked at.
  const double blur = technique.photons == Use::on ? 0.005 : 0;
  TestFamily tests;
  for (int q = 0; q < 5; ++q)
    for (int c = 0; c < 3; ++c) {
      const RunningMean &a = plain.part[q][c], &b = other.part[q][c];
      const double error = std::hypot(a.standard_error(), b.standard_error());
      EXPECT_LT(error, (q == 4 ? 0.004 : 0.012) * a.mean());
      tests.add(fmt::format("part {}, channel {}: {} and {} ± {}", q, c, a.mean(), b.mean(), error),
                normal_p(std::max(0.0, std::abs(a.mean() - b.mean()) - blur * a.mean()) / error));
    }
  EXPECT_TRUE(tests.holds());
}

const Technique kPhotons{"photons", Use::on, Use::off};
const Technique kReuse{"reuse", Use::off, Use::on};
const Technique kBoth{"both", Use::on, Use::on, SamplerKind::independent};

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
