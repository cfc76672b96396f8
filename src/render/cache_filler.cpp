#include "render/cache_filler.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/parallel.h"
#include "render/generations.h"
#include "sampling/hash.h"

namespace etendue {
namespace {

constexpr int kBatch = Geometry::kBatch;

/// Of the pixels, one in so many is sampled for the cache, as often as all are for the picture, as far as memory
/// allows.
constexpr std::uint64_t kPixelsPerRecord = 8;
/// Of the first generation's cells, in pixels; where fewer pixels are sampled, cells are larger.
constexpr float kCellInPixels = 8;
/// Their sides, and what they hold of directions, ∝ (generation + 1)^−⅙.
constexpr float kShrinking = -1.0f / 6;

using Found = std::optional<RadianceRecord>;

/// Records of a generation that fit into memory. They are collected before the cache is made of them.
std::uint64_t most_records(const RenderSettings& settings) {
  constexpr std::size_t kBytesPerRecord =
      sizeof(RadianceRecord) + std::max(sizeof(Found) + 1, RadianceCache::kBytesPerRecord);
  return record_memory(settings) / kBytesPerRecord;
}

std::uint32_t samples_of_pixel(const RenderSettings& settings) {
  const std::uint64_t most = most_records(settings) / kBatch * kBatch;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(usual_generation_size(settings), most));
}

std::uint64_t pixels_per_record(const RenderSettings& settings) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  const std::uint64_t usual = kPixelsPerRecord * usual_generation_size(settings) / worthwhile_samples(settings);
  const std::uint64_t most = most_records(settings) / samples_of_pixel(settings);
  return std::max(usual, (pixels + most - 1) / most);
}

}  // namespace

bool looks_up(const RenderSettings& settings) {
  if (settings.max_depth < 3 || (settings.for_denoising && settings.cache != Use::on)) return false;
  return uses(settings, settings.cache);
}

CacheFiller::CacheFiller(const RenderSettings& settings, float pixel_width)
    : width_(static_cast<std::uint64_t>(settings.width)),
      pixels_(width_ * static_cast<std::uint64_t>(settings.height)),
      samples_(samples_of_pixel(settings)),
      pixels_per_record_(pixels_per_record(settings)),
      cell_side_(kCellInPixels * pixel_width * std::sqrt(static_cast<float>(pixels_per_record_) / kPixelsPerRecord)) {}

std::vector<RadianceRecord> CacheFiller::collect(std::uint32_t generation, const Record& record,
                                                 std::uint64_t& rays) const {
  const std::uint64_t chosen = (pixels_ + pixels_per_record_ - 1) / pixels_per_record_;
  std::vector<Found> found(chosen * samples_);
  std::vector<std::uint64_t> traced(chosen);
  parallel_for(chosen, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const std::uint32_t one =
          hash_combine(generation, static_cast<std::uint32_t>(c)) % static_cast<std::uint32_t>(pixels_per_record_);
      const std::uint64_t pixel = std::min(c * pixels_per_record_ + one, pixels_ - 1);
      for (std::uint32_t first = 0; first < samples_; first += kBatch)
        traced[c] += record(static_cast<int>(pixel % width_), static_cast<int>(pixel / width_),
                            generation * samples_ + first, std::span(found).subspan(c * samples_ + first, kBatch));
    }
  });
  rays = std::accumulate(traced.begin(), traced.end(), rays);
  std::vector<RadianceRecord> records;
  records.reserve(static_cast<std::size_t>(std::ranges::count_if(found, &Found::has_value)));
  for (const Found& r : found)
    if (r) records.push_back(*r);
  return records;
}

std::uint64_t CacheFiller::fill(std::uint32_t generation, const Geometry& geometry, std::optional<RadianceCache>& cache,
                                const Record& record) const {
  std::uint64_t rays = 0;
  const std::vector<RadianceRecord> records = collect(generation, record, rays);
  const float width = std::pow(static_cast<float>(generation + 1), kShrinking);
  const auto offset = [&](std::uint32_t axis) { return to_unit_float(hash_combine(generation, axis)); };
  cache.emplace(records, geometry, cell_side_ * width, 1 / width, Vec3(offset(0), offset(1), offset(2)));
  return rays + cache->rays();
}

}  // namespace etendue
