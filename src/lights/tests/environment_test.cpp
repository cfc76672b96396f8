#include "lights/environment.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "lights/light.h"
#include "testing/quadrature.h"
#include "testing/random.h"
#include "testing/sphere_grid.h"

namespace etendue {
namespace {

Image noise(int width, int height, std::uint64_t seed) {
  Random random(seed);
  Image map(width, height);
  for (Spectrum& s : map.pixels()) s = {random.value(), random.value(), random.value()};
  return map;
}

/// Black but for one texel.
Image sun(int width, int height, int x, int y) {
  Image map(width, height);
  map.at(x, y) = Spectrum(1e5f);
  return map;
}

/// Every second column is black, and the middle and last rows.
Image stripes(int width, int height) {
  Image map(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (x % 2 == 0 && y != height / 2 && y != height - 1) map.at(x, y) = Spectrum(1 + static_cast<float>(y));
  return map;
}

struct NamedMap {
  std::string name;
  Image map;
};

std::vector<NamedMap> all_maps() {
  return {
      {"noise", noise(16, 8, 1)},
      {"odd sizes", noise(7, 5, 2)},
      {"one texel", noise(1, 1, 3)},
      {"one row", noise(9, 1, 4)},
      {"one column", noise(1, 9, 5)},
      {"sun", sun(32, 16, 20, 5)},
      {"sun in the corner", sun(16, 8, 0, 0)},
      {"sun in the last texel", sun(16, 8, 15, 7)},
      {"black", Image(8, 4)},
      {"stripes", stripes(12, 6)},
      {"two suns",
       [] {
         Image map = sun(64, 32, 3, 3);
         map.at(60, 30) = Spectrum(1e3f);
         return map;
       }()},
  };
}

/// What the comments promise: luminance · sin θ over the texel, normalised; the solid angle if all is black.
std::vector<double> promised_probabilities(const Image& map) {
  std::vector<double> p;
  double total = 0, light = 0;
  for (const Spectrum& s : map.pixels()) light += s.luminance();
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) {
      const double top = std::numbers::pi * y / map.height(), bottom = std::numbers::pi * (y + 1) / map.height();
      p.push_back((light > 0 ? map.at(x, y).luminance() : 1.0) * (std::cos(top) - std::cos(bottom)));
      total += p.back();
    }
  for (double& value : p) value /= total;
  return p;
}

std::size_t texel_of(const Image& map, Vec2 uv) {
  return static_cast<std::size_t>(uv.y * static_cast<float>(map.height())) * map.width() +
         static_cast<std::size_t>(uv.x * static_cast<float>(map.width()));
}

TEST(TexelDistribution, ChoosesTexelsWithTheirProbabilities) {
  TestFamily family;
  for (const NamedMap& named : all_maps()) {
    const TexelDistribution distribution(named.map);
    std::vector<double> expected = promised_probabilities(named.map), counts(expected.size());
    constexpr int kSamples = 100000;
    Random random(1);
    for (int i = 0; i < kSamples; ++i) {
      const auto s = distribution.sample(random.point());
      ASSERT_TRUE(s.uv.x >= 0 && s.uv.x < 1 && s.uv.y >= 0 && s.uv.y < 1) << named.name;
      const std::size_t texel = texel_of(named.map, s.uv);
      ASSERT_GT(expected[texel], 0) << named.name << ": a texel without light was chosen";
      ++counts[texel];
    }
    for (double& e : expected) e *= kSamples;
    family.add(named.name, chi_square_test(counts, expected).p);
  }
  EXPECT_TRUE(family.holds());
}

TEST(TexelDistribution, IsUniformWithinATexel) {
  TestFamily family;
  for (const NamedMap& named : all_maps()) {
    const TexelDistribution distribution(named.map);
    Random random(2);
    std::vector<double> counts(64);
    for (int i = 0; i < 50000; ++i) {
      const Vec2 uv = distribution.sample(random.point()).uv;
      const float x = uv.x * static_cast<float>(named.map.width()), y = uv.y * static_cast<float>(named.map.height());
      ++counts[static_cast<std::size_t>((y - std::floor(y)) * 8) * 8 +
               static_cast<std::size_t>((x - std::floor(x)) * 8)];
    }
    family.add(named.name, uniform_test(counts).p);
  }
  EXPECT_TRUE(family.holds());
}

TEST(TexelDistribution, DensityIntegratesToOneAndAgreesWithSamples) {
  for (const NamedMap& named : all_maps()) {
    const TexelDistribution distribution(named.map);
    const int w = named.map.width(), h = named.map.height();
    const std::vector<double> promised = promised_probabilities(named.map);
    double integral = 0;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const Vec2 center((static_cast<float>(x) + 0.5f) / static_cast<float>(w),
                          (static_cast<float>(y) + 0.5f) / static_cast<float>(h));
        const double probability = static_cast<double>(distribution.pdf(center)) / (w * h);
        EXPECT_NEAR(probability, promised[static_cast<std::size_t>(y) * w + x], 1e-6) << named.name;
        integral += probability;
      }
    EXPECT_NEAR(integral, 1, 1e-5) << named.name;
    Random random(3);
    for (int i = 0; i < 1000; ++i) {
      const auto s = distribution.sample(random.point());
      EXPECT_EQ(s.pdf, distribution.pdf(s.uv)) << named.name;
    }
  }
}

TEST(TexelDistribution, NeverChoosesBlackTexels) {
  const float kEnds[] = {0, 0x1p-24f, 0.25f, 0.5f, 0.75f, kOneMinusEpsilon};
  for (const NamedMap& named : all_maps()) {
    const TexelDistribution distribution(named.map);
    const std::vector<double> promised = promised_probabilities(named.map);
    for (const float u : kEnds)
      for (const float v : kEnds) {
        const auto s = distribution.sample({u, v});
        // A point at a texel's far edge may be rounded to the edge.
        const double here = promised[texel_of(named.map, s.uv)];
        const double before_x = promised[texel_of(named.map, {s.uv.x * (1 - 0x1p-22f), s.uv.y})];
        const double before_y = promised[texel_of(named.map, {s.uv.x, s.uv.y * (1 - 0x1p-22f)})];
        const double before = promised[texel_of(named.map, s.uv * (1 - 0x1p-22f))];
        EXPECT_GT(std::max({here, before_x, before_y, before}), 0) << named.name << ' ' << u << ' ' << v;
        EXPECT_GT(s.pdf, 0) << named.name;
      }
  }
}

/// However the search is guided: the interval that holds u is the one that is found.
TEST(TexelDistribution, InvertsItsCumulativeProbabilities) {
  std::vector<NamedMap> maps = all_maps();
  maps.push_back({"large map", noise(301, 199, 12)});
  maps.back().map.at(17, 40) = Spectrum(1e4f);
  for (const NamedMap& named : maps) {
    const TexelDistribution distribution(named.map);
    Random random(13);
    for (int i = 0; i < 20000; ++i) {
      const Vec2 u = random.point(), uv = distribution.sample(u).uv;
      const int row = static_cast<int>(uv.y * static_cast<float>(named.map.height()));
      const int column = static_cast<int>(uv.x * static_cast<float>(named.map.width()));
      const float tolerance = 2e-5f;
      ASSERT_LE(row > 0 ? distribution.row_cdf(row - 1) : 0, u.y + tolerance) << named.name << ' ' << u;
      ASSERT_GE(distribution.row_cdf(row), u.y - tolerance) << named.name << ' ' << u;
      ASSERT_LE(column > 0 ? distribution.column_cdf(row, column - 1) : 0, u.x + tolerance) << named.name << ' ' << u;
      ASSERT_GE(distribution.column_cdf(row, column), u.x - tolerance) << named.name << ' ' << u;
    }
  }
}

TEST(TexelDistribution, CumulativeProbabilitiesEndAtOne) {
  const Image map = noise(6, 4, 9);
  const TexelDistribution distribution(map);
  ASSERT_EQ(distribution.width(), 6);
  ASSERT_EQ(distribution.height(), 4);
  const std::vector<double> promised = promised_probabilities(map);
  double rows = 0;
  for (int y = 0; y < 4; ++y) {
    double row = 0, columns = 0;
    for (int x = 0; x < 6; ++x) row += promised[static_cast<std::size_t>(y) * 6 + x];
    for (int x = 0; x < 6; ++x) {
      columns += promised[static_cast<std::size_t>(y) * 6 + x] / row;
      EXPECT_NEAR(distribution.column_cdf(y, x), columns, 1e-6);
    }
    EXPECT_EQ(distribution.column_cdf(y, 5), 1);
    rows += row;
    EXPECT_NEAR(distribution.row_cdf(y), rows, 1e-6);
  }
  EXPECT_EQ(distribution.row_cdf(3), 1);
}

constexpr MapRows kBothRows[] = {MapRows::centered, MapRows::pole_to_pole};

TEST(LookupMeans, AreTheMeansOfTheLookup) {
  for (const MapRows rows : kBothRows)
    for (const NamedMap& named : all_maps()) {
      const Image means = lookup_means(named.map, rows);
      const int w = means.width(), h = means.height();
      EXPECT_EQ(w, named.map.width());
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          double sum = 0;
          constexpr int kSide = 16;
          for (int j = 0; j < kSide; ++j)
            for (int i = 0; i < kSide; ++i) {
              const Vec2 uv((static_cast<float>(x) + (static_cast<float>(i) + 0.5f) / kSide) / static_cast<float>(w),
                            (static_cast<float>(y) + (static_cast<float>(j) + 0.5f) / kSide) / static_cast<float>(h));
              sum += lookup_bilinear(named.map, uv, rows).g;
            }
          const double mean = sum / (kSide * kSide);
          EXPECT_NEAR(means.at(x, y).g, mean, 2e-3 * mean + 1e-6) << named.name << ' ' << x << ' ' << y;
        }
    }
}

/// Wherever the lookup gives light, the distribution of the means has a density.
TEST(LookupMeans, SupportCoversTheLookup) {
  for (const MapRows rows : kBothRows)
    for (const NamedMap& named : all_maps()) {
      const TexelDistribution distribution(lookup_means(named.map, rows));
      Random random(4);
      for (int i = 0; i < 20000; ++i) {
        const Vec2 uv = random.point();
        if (!lookup_bilinear(named.map, uv, rows).is_black()) {
          ASSERT_GT(distribution.pdf(uv), 0) << named.name << ' ' << uv;
        }
      }
    }
}

TEST(Compensated, LeavesWhatExceedsTheMeanOverTheSphere) {
  Image map(4, 3, Spectrum(1));
  map.at(2, 1) = Spectrum(9);  // of four texels in the middle row, which is half of the sphere
  const Image left = compensated(map);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x) EXPECT_NEAR(left.at(x, y).g, x == 2 && y == 1 ? 7 : 0, 1e-5) << x << ' ' << y;
}

TEST(Compensated, LeavesNothingOfAnEvenSky) {
  const Image left = compensated(Image(64, 31, Spectrum(0.3f, 0.7f, 0.1f)));
  for (const Spectrum& s : left.pixels()) EXPECT_TRUE(s.is_black());
  // … which is then sampled evenly.
  EXPECT_NEAR(TexelDistribution(left).pdf({0.3f, 0.5f}), kPi / 2, 0.01f);
}

TEST(RepairMap, ReplacesWhatIsNoRadiance) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  Image map(2, 2, Spectrum(0.5f));
  map.at(0, 0) = {kNan, 1, -1};
  map.at(1, 1) = {2, kInfinity, -kInfinity};
  const MapRepairs repairs = repair_map(map);
  EXPECT_EQ(repairs.invalid, 2u);
  EXPECT_FALSE(repairs.black);
  EXPECT_EQ(map.at(0, 0), Spectrum(0, 1, 0));
  EXPECT_EQ(map.at(1, 1), Spectrum(2, 0, 0));
  EXPECT_EQ(map.at(0, 1), Spectrum(0.5f));
  Image black(3, 3, {-1, 0, kNan});
  EXPECT_TRUE(repair_map(black).black);
  EXPECT_EQ(repair_map(map).invalid, 0u);
}

std::vector<MapOrientation> all_orientations() {
  std::vector<MapOrientation> list;
  for (const bool mirrored : {false, true})
    for (const float rotation : {0.0f, 0.5f, -2.0f, 3.14159265f, 100.0f}) list.push_back({rotation, mirrored});
  return list;
}

TEST(MapOrientation, DirectionsAndCoordinatesAreInverse) {
  Random random(5);
  for (const MapOrientation& orientation : all_orientations()) {
    const float tolerance = std::abs(orientation.rotation) > 10 ? 1e-4f : 2e-6f;  // the angle's own rounding
    for (int i = 0; i < 10000; ++i) {
      const Vec3 w = random.direction();
      const Vec2 uv = direction_to_uv(orientation, w);
      ASSERT_TRUE(uv.x >= 0 && uv.x < 1 && uv.y >= 0 && uv.y < 1) << w;
      ASSERT_LT(length(uv_to_direction(orientation, uv) - w), 2 * tolerance) << w;
      const Vec2 back = direction_to_uv(orientation, uv_to_direction(orientation, random.point()));
      ASSERT_TRUE(back.x >= 0 && back.x < 1 && back.y >= 0 && back.y < 1);
    }
  }
}

TEST(MapOrientation, PolesAreTheFirstAndLastRow) {
  for (const MapOrientation& orientation : all_orientations()) {
    EXPECT_EQ(direction_to_uv(orientation, {0, 1, 0}).y, 0);
    EXPECT_EQ(direction_to_uv(orientation, {0, -1, 0}).y, kOneMinusEpsilon);
    EXPECT_NEAR(direction_to_uv(orientation, {1, 0, 0}).y, 0.5f, 1e-7);
    // Very near a pole the angle is still known: v is not rounded to the pole.
    EXPECT_NEAR(direction_to_uv(orientation, {1e-6f, 1, 0}).y, 1e-6f * kInvPi, 1e-12);
  }
}

TEST(MapOrientation, StandardReadsFromLeftToRight) {
  const MapOrientation standard;
  // u = atan2(x, −z) / 2π: the map's left edge lies along −z, its second quarter begins at +x.
  EXPECT_NEAR(direction_to_uv(standard, {1e-3f, 0, -1}).x, 1e-3f / (2 * kPi), 1e-6);
  EXPECT_NEAR(direction_to_uv(standard, {1, 0, 0}).x, 0.25f, 1e-6);
  EXPECT_NEAR(direction_to_uv(standard, {0, 0, 1}).x, 0.5f, 1e-6);
  EXPECT_NEAR(direction_to_uv(standard, {-1, 0, 0}).x, 0.75f, 1e-6);
}

TEST(MapOrientation, MirroredIsTheFormulaOfTheCglProfile) {
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 w = random.direction();
    const Vec2 uv = direction_to_uv({0, true}, w);
    const double phi = std::atan2(-static_cast<double>(w.z), static_cast<double>(w.x)) + std::numbers::pi;
    const double difference = uv.x - phi / (2 * std::numbers::pi);
    EXPECT_NEAR(difference - std::round(difference), 0, 1e-6) << w;
    EXPECT_NEAR(uv.y, std::acos(static_cast<double>(w.y)) / std::numbers::pi, 1e-6) << w;
  }
}

TEST(MapOrientation, RotationIsCounterClockwiseSeenFromAbove) {
  // Seen from above (+y towards the eye) +x turns to −z: what stood along +x is then seen along −z.
  for (const bool mirrored : {false, true}) {
    const Vec2 before = direction_to_uv({0, mirrored}, {1, 0, 0});
    const Vec2 after = direction_to_uv({kPi / 2, mirrored}, Transform::rotation({0, 1, 0}, kPi / 2).vector({1, 0, 0}));
    const float difference = before.x - after.x;
    EXPECT_NEAR(difference - std::round(difference), 0, 1e-6);
    EXPECT_LT(length(Transform::rotation({0, 1, 0}, kPi / 2).vector({1, 0, 0}) - Vec3(0, 0, -1)), 1e-6f);
  }
}

TEST(LookupBilinear, IsExactAtCentresAndLinearBetween) {
  const Image map = noise(6, 4, 7);
  const auto center = [](int x, int y) {
    return Vec2((static_cast<float>(x) + 0.5f) / 6, (static_cast<float>(y) + 0.5f) / 4);
  };
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 6; ++x)
      EXPECT_NEAR(lookup_bilinear(map, center(x, y), MapRows::centered).r, map.at(x, y).r, 1e-5);
  const Vec2 between = (center(2, 1) + center(3, 2)) * 0.5f;
  EXPECT_NEAR(lookup_bilinear(map, between, MapRows::centered).b,
              (map.at(2, 1) + map.at(3, 1) + map.at(2, 2) + map.at(3, 2)).b / 4, 1e-5);
}

TEST(LookupBilinear, WrapsAroundAndIsClampedAtThePoles) {
  const Image map = noise(6, 4, 8);
  const float middle = 1.5f / 4;
  const float seam = 0.5f * (map.at(5, 1).r + map.at(0, 1).r);
  EXPECT_NEAR(lookup_bilinear(map, {0, middle}, MapRows::centered).r, seam, 1e-6);
  EXPECT_NEAR(lookup_bilinear(map, {kOneMinusEpsilon, middle}, MapRows::centered).r, seam, 1e-5);
  for (int x = 0; x < 6; ++x) {
    const float u = (static_cast<float>(x) + 0.5f) / 6;
    EXPECT_NEAR(lookup_bilinear(map, {u, 0}, MapRows::centered).g, map.at(x, 0).g, 1e-5);
    EXPECT_NEAR(lookup_bilinear(map, {u, 0.1f}, MapRows::centered).g, map.at(x, 0).g, 1e-5);
    EXPECT_NEAR(lookup_bilinear(map, {u, kOneMinusEpsilon}, MapRows::centered).g, map.at(x, 3).g, 1e-5);
  }
}

TEST(LookupBilinear, RowsReachFromPoleToPole) {
  const Image map = noise(6, 5, 9);
  for (int x = 0; x < 6; ++x) {
    const float u = (static_cast<float>(x) + 0.5f) / 6;
    EXPECT_NEAR(lookup_bilinear(map, {u, 0}, MapRows::pole_to_pole).g, map.at(x, 0).g, 1e-5);
    EXPECT_NEAR(lookup_bilinear(map, {u, 0.5f}, MapRows::pole_to_pole).g, map.at(x, 2).g, 1e-5);
    EXPECT_NEAR(lookup_bilinear(map, {u, 0.375f}, MapRows::pole_to_pole).g, 0.5f * (map.at(x, 1).g + map.at(x, 2).g),
                1e-5);
    EXPECT_NEAR(lookup_bilinear(map, {u, kOneMinusEpsilon}, MapRows::pole_to_pole).g, map.at(x, 4).g, 1e-5);
  }
}

}  // namespace
}  // namespace etendue
