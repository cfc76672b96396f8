#include "photons/photon_spread.h"

#include <gtest/gtest.h>

#include <random>

namespace etendue {
namespace {

constexpr float kRadius = 0.01f;

/// On the plane y = 0, many in the unit square, few beyond it.
std::vector<Photon> on_a_floor(unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> u(0, 1);
  std::vector<Photon> photons(160'000);
  for (std::size_t i = 0; i < photons.size(); ++i) {
    photons[i].normal = {0, 1, 0};
    photons[i].position = i < 159'000 ? Point3(u(rng), 0, u(rng)) : Point3(1 + 3 * u(rng), 0, 4 * u(rng));
  }
  return photons;
}

TEST(PhotonSpread, RareOnesReachFarther) {
  const PhotonSpread spread(on_a_floor(1), 1, kRadius);
  EXPECT_EQ(spread.level({0.5f, 0, 0.5f}), 0);
  EXPECT_EQ(spread.level({3, 0, 3}), PhotonSpread::kLevels - 1);
  EXPECT_EQ(spread.level({0, 50, 0}), PhotonSpread::kLevels - 1);
  EXPECT_EQ(spread.kept({3, 0, 3}), 1.0f);
}

TEST(PhotonSpread, DisksAreNoWiderThanTheSurfaceIsFlat) {
  std::vector<Photon> pilot = on_a_floor(1);
  for (std::size_t i = 0; i < pilot.size(); ++i) pilot[i].normal = i % 2 == 0 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const PhotonSpread spread(pilot, 1, kRadius);
  EXPECT_LT(spread.level({3, 0, 3}), PhotonSpread::kLevels - 1);
}

TEST(PhotonSpread, ManyAreThinnedOut) {
  std::vector<Photon> pilot = on_a_floor(1);
  for (int i = 0; i < 20'000; ++i) pilot.push_back(pilot[0]);
  const PhotonSpread spread(pilot, 1, kRadius);
  EXPECT_LT(spread.kept(pilot[0].position), 0.01f);
  EXPECT_EQ(spread.level(pilot[0].position), 0);
}

TEST(PhotonMaps, LookupsOfAPlacesLevelFindAllWithinItsRadius) {
  const std::vector<Photon> photons = on_a_floor(2);
  const PhotonSpread spread(on_a_floor(1), 1, kRadius);
  const PhotonMaps maps(photons, spread, kRadius);
  std::size_t found = 0;
  for (std::size_t i = 158'900; i < 159'400; ++i) {
    const Point3 asked = photons[i].position + Vec3(0.003f, 0, 0.003f);
    const int level = spread.level(asked);
    EXPECT_FLOAT_EQ(maps.radius(level), kRadius * static_cast<float>(1 << level));
    std::size_t near = 0, seen = 0;
    for (const Photon& photon : photons)
      near += length_squared(photon.position - asked) < maps.radius(level) * maps.radius(level) ? 1 : 0;
    maps.for_each_near(asked, level, [&](const Photon&) { ++seen; });
    EXPECT_EQ(seen, near);
    found += seen;
  }
  EXPECT_GT(found, 1000u);
}

}  // namespace
}  // namespace etendue
