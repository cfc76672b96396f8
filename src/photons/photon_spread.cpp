#include "photons/photon_spread.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sampling/hash.h"

namespace etendue {
namespace {

/// Side of the cells in which the pilot is counted, in finest radii: as wide as the largest disk's radius, and as the
/// finest disk.
constexpr float kCoarse = 16, kFine = 2;
/// A disk is widened while it is expected to hold fewer photons than this.
constexpr float kFewest = 48;
/// Nor further than the surface is flat: 1 − the length of the mean normal within a cell, for the widest disk, which is
/// as wide as its normals turn by 45°; four times as much for half the disk.
constexpr float kMostBend = 0.025f;
/// Of which a finest disk is expected to hold so many at most; more are thinned out.
constexpr float kMost = 16;

}  // namespace

PhotonSpread::PhotonSpread(std::span<const Photon> pilot, float each, float finest)
    : reach_(static_cast<float>(1 << (kLevels - 1)) * finest),
      coarse_(pilot, each, kCoarse * finest),
      fine_(pilot, each, kFine * finest) {}

PhotonSpread::Counts::Counts(std::span<const Photon> pilot, float each_in, float side)
    : cells_per_metre(1 / side), each(each_in), buckets(std::bit_ceil(4 * pilot.size() + 1)) {
  normals.resize(buckets.size(), Vec3(0, 0, 0));
  for (const Photon& photon : pilot) {
    const std::size_t b = bucket(photon.position);
    ++buckets[b];
    normals[b] = normals[b] + photon.normal;
  }
}

float PhotonSpread::Counts::flatness(const Point3& position) const {
  const std::size_t b = bucket(position);
  return buckets[b] > 0 ? length(normals[b]) / static_cast<float>(buckets[b]) : 1.0f;
}

std::size_t PhotonSpread::Counts::bucket(const Point3& position) const {
  std::uint32_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float cell = std::clamp(std::floor(position[axis] * cells_per_metre), -1e9f, 1e9f);
    hash = hash_combine(hash, static_cast<std::uint32_t>(static_cast<std::int32_t>(cell)));
  }
  return hash & (buckets.size() - 1);
}

float PhotonSpread::Counts::at(const Point3& position) const {
  return buckets.empty() ? 0.0f : each * static_cast<float>(buckets[bucket(position)]);
}

int PhotonSpread::level(const Point3& position) const {
  int level = 0;
  float held = coarse_.at(position) * kPi / square(kCoarse);
  float bend = held < kFewest ? 1 - coarse_.flatness(position) : 0.0f;
  for (float most = kMostBend * static_cast<float>(1 << 2 * (kLevels - 2));
       held < kFewest && level + 1 < kLevels && bend <= most; held *= 4, most /= 4)
    ++level;
  return level;
}

unsigned PhotonSpread::levels_around(const Point3& position) const {
  static_assert(kCoarse >= 1 << (kLevels - 1), "steps as wide as the largest radius would leave out cells");
  unsigned levels = 0;
  for (int i = 0; i < 27; ++i) {
    const int x = i % 3 - 1, y = i / 3 % 3 - 1, z = i / 9 - 1;
    const Vec3 step(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    levels |= 1u << level(position + step * reach_);
  }
  return levels;
}

float PhotonSpread::held(const Point3& position) const {
  return kPi * std::max(coarse_.at(position) / square(kCoarse), fine_.at(position) / square(kFine));
}

float PhotonSpread::kept(const Point3& position) const {
  return kMost / std::max(held(position), kMost);
}

PhotonMaps::PhotonMaps(std::span<const Photon> photons, const PhotonSpread& spread, float finest) {
  std::array<std::vector<Photon>, PhotonSpread::kLevels> by_level;
  for (const Photon& photon : photons) {
    const unsigned levels = spread.levels_around(photon.position);
    for (int level = 0; level < PhotonSpread::kLevels; ++level)
      if ((levels >> level & 1) != 0) by_level[level].push_back(photon);
  }
  for (int level = 0; level < PhotonSpread::kLevels; ++level)
    maps_[level] = PhotonMap(std::move(by_level[level]), finest * static_cast<float>(1 << level));
}

}  // namespace etendue
