#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "photons/photon_map.h"

namespace etendue {

/// How dense photons lie where, learned from a pilot: where they are rare, a lookup takes those of a larger disk; where
/// there are more than help, only some are kept. A function of the place alone, so that what a photon is worth does not
/// depend on the others.
class PhotonSpread {
 public:
  /// Disks are as large as the finest, or 2, 4, 8 or 16 times as wide.
  static constexpr int kLevels = 5;
  /// Two grids of up to eight buckets a photon of the pilot.
  static constexpr std::size_t kBytesPerPhoton = 2 * (8 * (sizeof(std::uint32_t) + sizeof(Vec3)));

  PhotonSpread() = default;
  /// `pilot`: each stands for so many of those that there will be. `finest`: radius in metres.
  PhotonSpread(std::span<const Photon> pilot, float each, float finest);

  /// Of lookups at a place.
  int level(const Point3& position) const;
  /// Bit l is set if the disk of some lookup of level l may hold the position.
  unsigned levels_around(const Point3& position) const;
  /// Photons expected within a finest disk there.
  float held(const Point3& position) const;
  /// Share of the photons to keep there, in (0, 1].
  float kept(const Point3& position) const;

 private:
  /// The pilot's photons in the cells of a grid, by hash.
  struct Counts {
    Counts() = default;
    Counts(std::span<const Photon> pilot, float each, float side);
    float at(const Point3& position) const;
    std::size_t bucket(const Point3& position) const;

    /// Length of the mean of their normals: 1 where the surface is flat.
    float flatness(const Point3& position) const;

    float cells_per_metre = 0, each = 1;
    std::vector<std::uint32_t> buckets;
    std::vector<Vec3> normals;  ///< their sums
  };
  float reach_ = 0;  ///< of the widest disks
  Counts coarse_, fine_;
};

/// Photons for lookups of all levels.
class PhotonMaps {
 public:
  /// At most: where each level's lookups may find it.
  static constexpr std::size_t kBytesPerPhoton = PhotonSpread::kLevels * PhotonMap::kBytesPerPhoton;
  static constexpr std::size_t kFewestBytes = PhotonSpread::kLevels * PhotonMap::kFewestBytes;
  /// More for what is needed while they are made: lists that grow to up to twice what they hold.
  static constexpr std::size_t kBytesToMake = 2 * (PhotonSpread::kLevels * sizeof(Photon)) + PhotonMap::kBytesToMake;

  PhotonMaps() = default;
  /// `finest`: radius, at most that of the spread.
  PhotonMaps(std::span<const Photon> photons, const PhotonSpread& spread, float finest);

  /// Calls `see(photon)` for all photons within the disk of a level.
  template <typename See>
  void for_each_near(const Point3& position, int level, See&& see) const {
    maps_[level].for_each_near(position, see);
  }
  float radius(int level) const { return maps_[level].radius(); }

 private:
  std::array<PhotonMap, PhotonSpread::kLevels> maps_;
};

}  // namespace etendue
