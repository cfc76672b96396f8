#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/bounds.h"
#include "math/spectrum.h"
#include "math/vec.h"

namespace etendue {

/// Light that arrived at a surface.
struct Photon {
  Point3 position;
  Vec3 wi;            ///< unit, to where it came from
  Vec3 normal;        ///< unit, of the surface, geometric
  Spectrum flux;      ///< in W, of one emitted photon: not yet divided by their number
  float density;      ///< with which one emitted photon arrives like this, per m² of surface facing wi and sr
  int bounces = 0;    ///< between the light and here
  bool ends = false;  ///< is not scattered on from here
};

/// Photons by where they are: a hashed grid, built once, read by all threads.
class PhotonMap {
  /// For few photons; more share the work of a lookup, but cost memory that lookups wait for.
  static constexpr std::size_t kFewestBuckets = 1 << 10, kMostBuckets = 1 << 22;

 public:
  /// A map has up to four buckets a photon, or kFewestBuckets; of each a start and a bit.
  static constexpr std::size_t kFewestBytes = kFewestBuckets * (sizeof(std::uint32_t) + 1);
  static constexpr std::size_t kBytesPerPhoton = sizeof(Photon) + sizeof(Point3) + 4 * sizeof(std::uint32_t) + 1;
  /// More for what is needed while it is made, but for the photons given.
  static constexpr std::size_t kBytesToMake = 5 * sizeof(std::uint32_t);

  PhotonMap() = default;
  /// For lookups within `radius`, in metres. The order of `photons` decides the order in which lookups see them.
  PhotonMap(std::vector<Photon> photons, float radius);

  bool empty() const { return photons_.empty(); }
  std::size_t size() const { return photons_.size(); }
  float radius() const { return radius_; }

  /// Calls `see(photon)` for all photons nearer to `position` than radius().
  template <typename See>
  void for_each_near(const Point3& position, See&& see) const {
    if (photons_.empty()) return;
    Buckets buckets;
    const int count = buckets_around(position, buckets);
    for (int i = 0; i < count; ++i)
      for (std::uint32_t p = starts_[buckets[i]]; p < starts_[buckets[i] + 1]; ++p)
        if (length_squared(positions_[p] - position) < radius_ * radius_) see(photons_[p]);
  }

 private:
  using Buckets = std::array<std::uint32_t, 8>;
  /// The different buckets, not empty, of the eight cells that the sphere around `position` may reach.
  int buckets_around(const Point3& position, Buckets& buckets) const;
  std::uint32_t bucket(int x, int y, int z) const;
  int cell(float coordinate) const;
  bool occupied(std::uint32_t bucket) const { return (occupied_[bucket / 64] >> (bucket % 64) & 1) != 0; }

  float radius_ = 0, cells_per_metre_ = 0;
  std::uint32_t mask_ = 0;
  std::vector<std::uint32_t> starts_;    ///< of each bucket among photons_, and their end
  std::vector<std::uint64_t> occupied_;  ///< a bit a bucket: most lookups find nothing, and this fits the nearest cache
  std::vector<Photon> photons_;          ///< by bucket
  std::vector<Point3> positions_;        ///< of each: most of what a lookup sees is too far away
};

}  // namespace etendue
