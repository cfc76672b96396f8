#include "photons/photon_map.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sampling/hash.h"

namespace etendue {
PhotonMap::PhotonMap(std::vector<Photon> photons, float radius)
    : radius_(radius),
      cells_per_metre_(1 / (2 * radius)),
      mask_(static_cast<std::uint32_t>(std::clamp(std::bit_ceil(2 * photons.size()), kFewestBuckets, kMostBuckets)) -
            1) {
  starts_.assign(std::size_t{mask_} + 2, 0);
  std::vector<std::uint32_t> bucket_of;
  bucket_of.reserve(photons.size());
  for (const Photon& p : photons) {
    bucket_of.push_back(bucket(cell(p.position.x), cell(p.position.y), cell(p.position.z)));
    ++starts_[bucket_of.back() + 1];
  }
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  occupied_.assign((std::size_t{mask_} + 64) / 64, 0);
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  photons_.resize(photons.size());
  for (std::size_t i = 0; i < photons.size(); ++i) {
    photons_[next[bucket_of[i]]++] = photons[i];
    occupied_[bucket_of[i] / 64] |= std::uint64_t{1} << (bucket_of[i] % 64);
  }
  positions_.reserve(photons.size());
  for (const Photon& photon : photons_) positions_.push_back(photon.position);
}

int PhotonMap::cell(float coordinate) const {
  return static_cast<int>(std::clamp(std::floor(coordinate * cells_per_metre_), -1e9f, 1e9f));
}

std::uint32_t PhotonMap::bucket(int x, int y, int z) const {
  const auto u = [](int i) { return static_cast<std::uint32_t>(i); };
  return mix_bits(u(x) * 0x9e3779b1u ^ u(y) * 0x85ebca6bu ^ u(z) * 0xc2b2ae35u) & mask_;
}

int PhotonMap::buckets_around(const Point3& position, Buckets& buckets) const {
  // Cells are as wide as the sphere: it reaches at most one neighbour along each axis.
  const int x = cell(position.x - radius_), y = cell(position.y - radius_), z = cell(position.z - radius_);
  int count = 0;
  for (int i = 0; i < 8; ++i) {
    const std::uint32_t b = bucket(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
    if (occupied(b) && std::find(buckets.begin(), buckets.begin() + count, b) == buckets.begin() + count)
      buckets[count++] = b;
  }
  return count;
}

}  // namespace etendue
