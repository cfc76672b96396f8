#include "render/radiance_cache.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "sampling/hash.h"

namespace etendue {
namespace {

/// Between two records on one level the way is tested that far above them, in distances between them: a surface that
/// bulges is not in its own way.
constexpr float kLift = 0.25f;

std::uint32_t step(float x) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(std::clamp(x, -1e9f, 1e9f))));
}

bool sees(const Geometry& geometry, const RadianceRecord& a, const RadianceRecord& b) {
  const float distance = length(b.position - a.position);
  if (!(distance > 0)) return true;
  const float lift = a.medium == kNone ? kLift * distance : 0;
  const Point3 from = a.position + a.normal * lift, to = b.position + b.normal * lift;
  const Vec3 d = to - from;
  const float way = length(d);
  if (!(way > 0)) return true;
  Ray ray{from, d * (1 / way)};
  ray.t_max = way;
  return geometry.occluded(std::span<const Ray>(&ray, 1)) == 0;
}

}  // namespace

std::uint64_t RadianceCache::key(const RadianceRecord& record, int level) const {
  const float cells_per_metre = 1 / (side_ * static_cast<float>(1 << level));
  std::uint32_t low = static_cast<std::uint32_t>(record.bounces_left) * 4 + static_cast<std::uint32_t>(level),
                high = ~low;
  const auto add = [&](std::uint32_t value) {
    low = hash_combine(low, value);
    high = hash_combine(high, value ^ 0x5bd1e995u);
  };
  add(record.medium);
  for (int axis = 0; axis < 3; ++axis) {
    add(step((record.position[axis] + offset_[axis]) * cells_per_metre));
    add(step(record.normal[axis] * (record.turns * sharpness_) + 0.5f));
  }
  return std::uint64_t{std::max(high, 1u)} << 32 | low;
}

const RadianceCache::Cell* RadianceCache::Level::find(std::uint64_t key) const {
  if (cells.empty()) return nullptr;
  const std::size_t mask = cells.size() - 1;
  for (std::size_t i = key & mask;; i = (i + 1) & mask) {
    if (cells[i].key == 0) return nullptr;
    if (cells[i].key == key >> 32) return &cells[i];
  }
}

void RadianceCache::Level::insert(std::uint64_t key, const Cell& cell) {
  const std::size_t mask = cells.size() - 1;
  std::size_t i = key & mask;
  while (cells[i].key != 0) i = (i + 1) & mask;
  cells[i] = cell;
  cells[i].key = static_cast<std::uint32_t>(key >> 32);
}

std::uint64_t RadianceCache::fill(int level, std::span<const RadianceRecord> records, const Geometry& geometry) {
  std::vector<Keyed> order;
  order.reserve(records.size());
  for (std::uint32_t i = 0; i < records.size(); ++i) order.emplace_back(key(records[i], level), i);
  std::ranges::sort(order);
  levels_[level].cells.resize(std::bit_ceil(2 * (records.size() / kFewest) + 2));
  std::uint64_t rays = 0;
  for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
    end = begin + 1;
    while (end < order.size() && order[end].first == order[begin].first) ++end;
    if (end - begin < kFewest) continue;
    Light sum;
    bool open = true;
    for (std::size_t i = begin; i < end && open; ++i) {
      const RadianceRecord& record = records[order[i].second];
      if (i > begin) {
        open = sees(geometry, records[order[i - 1].second], record);
        ++rays;
      }
      sum.radiance += record.radiance;
      sum.caustics += record.caustics;
    }
    const float share = 1 / static_cast<float>(end - begin);
    levels_[level].insert(order[begin].first, {{sum.radiance * share, sum.caustics * share}, open});
  }
  return rays;
}

RadianceCache::RadianceCache(std::span<const RadianceRecord> records, const Geometry& geometry, float side,
                             float sharpness, const Vec3& offset)
    : side_(side), sharpness_(sharpness), offset_(offset * (static_cast<float>(1 << (kLevels - 1)) * side)) {
  std::array<std::uint64_t, kLevels> rays{};
  parallel_for(kLevels, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t level = begin; level < end; ++level)
      rays[level] = fill(static_cast<int>(level), records, geometry);
  });
  for (const std::uint64_t r : rays) rays_ += r;
}

const RadianceCache::Light* RadianceCache::find(const RadianceRecord& like) const {
  for (int level = 0; level < kLevels; ++level) {
    const Cell* cell = levels_[level].find(key(like, level));
    if (cell) return cell->open ? &cell->light : nullptr;
  }
  return nullptr;
}

}  // namespace etendue
