#include "photons/photon_map.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace etendue {
namespace {

std::vector<Photon> random_photons(int count, float extent, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> coordinate(-extent, extent);
  std::vector<Photon> photons(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    photons[i].position = {coordinate(rng), coordinate(rng), coordinate(rng)};
    photons[i].bounces = i;
  }
  return photons;
}

/// Indices of what a lookup sees; twice the same would be a light twice as bright.
std::multiset<int> seen_near(const PhotonMap& map, const Point3& p) {
  std::multiset<int> seen;
  map.for_each_near(p, [&](const Photon& photon) { seen.insert(photon.bounces); });
  return seen;
}

void expect_all_near(int count, float extent, float radius) {
  const std::vector<Photon> photons = random_photons(count, extent, 1);
  const PhotonMap map(photons, radius);
  int found = 0;
  for (const Photon& asked : random_photons(300, extent, 2)) {
    std::multiset<int> near;
    for (const Photon& photon : photons)
      if (length_squared(photon.position - asked.position) < radius * radius) near.insert(photon.bounces);
    EXPECT_EQ(seen_near(map, asked.position), near);
    found += static_cast<int>(near.size());
  }
  EXPECT_GT(found, 100);
}

TEST(PhotonMap, FindsExactlyThePhotonsWithinTheRadius) {
  expect_all_near(5000, 1, 0.1f);
}

TEST(PhotonMap, FindsThemWhenCellsShareBuckets) {
  expect_all_near(200, 1000, 400);
  expect_all_near(30000, 50, 2);
}

TEST(PhotonMap, FindsThemFarFromTheOrigin) {
  std::vector<Photon> photons = random_photons(1, 0, 1);
  photons[0].position = {1e12f, -1e12f, 1e12f};
  EXPECT_EQ(seen_near(PhotonMap(photons, 1e-3f), photons[0].position).size(), 1u);
}

TEST(PhotonMap, EmptyHasNothing) {
  EXPECT_TRUE(seen_near(PhotonMap(), {0, 0, 0}).empty());
  EXPECT_TRUE(seen_near(PhotonMap({}, 1), {0, 0, 0}).empty());
}

}  // namespace
}  // namespace etendue
