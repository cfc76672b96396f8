// The cache gives means of what was recorded, and only to surfaces like those that it was recorded on.

#include "render/radiance_cache.h"

#include <gtest/gtest.h>

#include <bit>

#include "render/settings.h"
#include "testing/random.h"

namespace etendue {
namespace {

constexpr float kCell = 0.125f;

/// A floor at y = 0, and a screen across it at x = 0 if asked for.
Geometry floor_and_screen(bool screen) {
  Geometry geometry;
  geometry.add(TriangleMesh{{{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}}, {}, {}, {{0, 1, 2}, {0, 2, 3}}});
  if (screen)
    geometry.add(TriangleMesh{{{0, -1, -9}, {0, -1, 9}, {0, 1, 9}, {0, 1, -9}}, {}, {}, {{0, 1, 2}, {0, 2, 3}}});
  geometry.build();
  return geometry;
}

RadianceRecord record(const Point3& position, float radiance = 0, const Vec3& normal = {0, 1, 0},
                      int bounces_left = kUnlimitedDepth) {
  return {.position = position,
          .normal = normal,
          .turns = 2,
          .bounces_left = bounces_left,
          .radiance = Spectrum(radiance, 2 * radiance, 0),
          .caustics = Spectrum(0, 0, 3 * radiance)};
}

/// `count` records of radiances 1, 2, …, close to each other on both sides of x.
std::vector<RadianceRecord> records_around(float x, int count, const Vec3& normal = {0, 1, 0},
                                           int bounces_left = kUnlimitedDepth) {
  std::vector<RadianceRecord> records;
  for (int i = 0; i < count; ++i)
    records.push_back(record({x + (i % 2 == 0 ? 0.01f : -0.01f), 0, 0.05f + 0.001f * static_cast<float>(i)},
                             static_cast<float>(i + 1), normal, bounces_left));
  return records;
}

class RadianceCacheTest : public ::testing::Test {
 protected:
  RadianceCache cache(const std::vector<RadianceRecord>& records, bool screen = false) const {
    return {records, screen ? with_screen_ : floor_, kCell, 1, {0.1f, 0.1f, 0.1f}};
  }

 private:
  Geometry floor_ = floor_and_screen(false), with_screen_ = floor_and_screen(true);
};

TEST_F(RadianceCacheTest, GivesTheMeanOfItsRecords) {
  const RadianceCache built = cache(records_around(0, 9));
  const RadianceCache::Light* light = built.find(record({0, 0, 0.055f}));
  ASSERT_NE(light, nullptr);
  EXPECT_FLOAT_EQ(light->radiance.r, 5);
  EXPECT_FLOAT_EQ(light->radiance.g, 10);
  EXPECT_FLOAT_EQ(light->radiance.b, 0);
  EXPECT_FLOAT_EQ(light->caustics.b, 15);
  EXPECT_FLOAT_EQ(light->caustics.r, 0);
}

TEST_F(RadianceCacheTest, KnowsNothingWhereThereWasNothing) {
  EXPECT_EQ(RadianceCache().find(record({0, 0, 0})), nullptr);
  EXPECT_EQ(cache({}).find(record({0, 0, 0})), nullptr);
  EXPECT_EQ(cache(records_around(0, 64)).find(record({5, 0, 5})), nullptr);
}

TEST_F(RadianceCacheTest, AFewRecordsAreNotEnough) {
  EXPECT_EQ(cache(records_around(0, 7)).find(record({0, 0, 0.055f})), nullptr);
  EXPECT_NE(cache(records_around(0, 8)).find(record({0, 0, 0.055f})), nullptr);
}

RadianceRecord in_medium(RadianceRecord record, float turns, std::uint32_t medium = 0) {
  record.turns = turns;
  record.medium = medium;
  return record;
}

/// What a medium scatters alike into all directions is known for all; what it does not, for those that are near.
TEST_F(RadianceCacheTest, TellsDirectionsApartInMediaThatDo) {
  for (const float turns : {0.0f, 2.0f}) {
    std::vector<RadianceRecord> records = records_around(0, 9);
    for (RadianceRecord& r : records) r = in_medium(r, turns);
    const RadianceCache built = cache(records);
    const RadianceRecord same = record({0, 0, 0.055f}), other = record({0, 0, 0.055f}, 0, {1, 0, 0});
    EXPECT_NE(built.find(in_medium(same, turns)), nullptr);
    EXPECT_EQ(built.find(in_medium(other, turns)) != nullptr, turns == 0);
    EXPECT_EQ(built.find(in_medium(same, turns, 1)), nullptr);
    EXPECT_EQ(built.find(same), nullptr);
  }
}

/// Finest cells that hold a few records each; together, in one coarse cell, they are enough.
TEST_F(RadianceCacheTest, CoarserCellsServeWhereRecordsAreFew) {
  std::vector<RadianceRecord> records;
  // The widest cells lie at 4 k · kCell − 0.05: four of the finest along x, and four along z.
  for (int i = 0; i < 16; ++i)
    records.push_back(
        record({kCell * (static_cast<float>(i % 4) + 0.2f), 0, kCell * (static_cast<float>(i / 4) + 0.2f)}, 1));
  const RadianceCache few = cache(records);
  const RadianceCache::Light* light = few.find(record({0.25f, 0, 0.25f}));
  ASSERT_NE(light, nullptr);
  EXPECT_FLOAT_EQ(light->radiance.r, 1);
  // Where many are close to each other they speak for themselves.
  const Point3 at{0.25f + 0.2f * kCell, 0, 0.25f + 0.2f * kCell};
  for (int i = 0; i < 15; ++i) records.push_back(record(at + Vec3(0, 0, 0.0005f * static_cast<float>(i)), 5));
  const RadianceCache more = cache(records);
  ASSERT_NE(more.find(record(at)), nullptr);
  EXPECT_FLOAT_EQ(more.find(record(at))->radiance.r, (15 * 5 + 1) / 16.0f);
}

TEST_F(RadianceCacheTest, SurfacesThatFaceElsewhereAreOthers) {
  const RadianceCache built = cache(records_around(0, 16));
  const Point3 at{0, 0, 0.055f};
  EXPECT_NE(built.find(record(at, 0, normalize(Vec3(0.05f, 1, 0.05f)))), nullptr);
  for (const Vec3& normal : {Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 0, -1), normalize(Vec3(1, 1, 0))})
    EXPECT_EQ(built.find(record(at, 0, normal)), nullptr) << normal.x << " " << normal.y << " " << normal.z;
}

TEST_F(RadianceCacheTest, LightOfOtherNumbersOfBouncesIsOther) {
  std::vector<RadianceRecord> records = records_around(0, 16, {0, 1, 0}, 2);
  for (RadianceRecord& r : records_around(0, 16, {0, 1, 0}, 3)) {
    r.radiance *= 7;
    records.push_back(r);
  }
  const RadianceCache built = cache(records);
  const auto found = [&](int bounces) { return built.find(record({0, 0, 0.055f}, 0, {0, 1, 0}, bounces)); };
  EXPECT_EQ(found(1), nullptr);
  EXPECT_EQ(found(kUnlimitedDepth), nullptr);
  ASSERT_TRUE(found(2) != nullptr && found(3) != nullptr);
  EXPECT_FLOAT_EQ(found(2)->radiance.r, 8.5f);
  EXPECT_FLOAT_EQ(found(3)->radiance.r, 7 * 8.5f);
}

TEST_F(RadianceCacheTest, NothingIsSaidAcrossAScreen) {
  const RadianceRecord like = record({0.01f, 0, 0.055f});
  EXPECT_NE(cache(records_around(0, 16), false).find(like), nullptr);
  EXPECT_EQ(cache(records_around(0, 16), true).find(like), nullptr);
  EXPECT_NE(cache(records_around(0.2f, 16), true).find(record({0.2f, 0, 0.055f})), nullptr) << "beside the screen";
}

TEST_F(RadianceCacheTest, IsTheSameEveryTime) {
  Random random(5);
  std::vector<RadianceRecord> records;
  for (int i = 0; i < 5000; ++i)
    records.push_back(record({static_cast<float>(random.between(-1, 1)), 0, static_cast<float>(random.between(-1, 1))},
                             static_cast<float>(random.between(0, 1))));
  const RadianceCache a = cache(records), b = cache(records);
  EXPECT_EQ(a.rays(), b.rays());
  EXPECT_GT(a.rays(), 0u);
  int known = 0;
  for (const RadianceRecord& like : records) {
    const RadianceCache::Light *x = a.find(like), *y = b.find(like);
    ASSERT_EQ(x == nullptr, y == nullptr);
    if (x == nullptr) continue;
    ++known;
    EXPECT_EQ(std::bit_cast<std::uint32_t>(x->radiance.r), std::bit_cast<std::uint32_t>(y->radiance.r));
  }
  EXPECT_GT(known, 4000);
}

}  // namespace
}  // namespace etendue
