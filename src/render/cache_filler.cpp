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

/// Of the pixels, one in so many is sampled for the cache, as often as all are for the picture; of large pictures so
/// many at most.
constexpr std::uint64_t kPixelsPerRecord = 8, kMostRecorded = 1 << 16;
/// Of the first generation's cells, in pixels; where fewer pixels are sampled, cells are larger.
constexpr float kCellInPixels = 8;
/// Their sides, and what they hold of directions, ∝ (generation + 1)^−⅙.
constexpr float kShrinking = -1.0f / 6;

std::uint64_t pixels_per_record(const RenderSettings& settings) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  const std::uint64_t usual = kPixelsPerRecord * usual_generation_size(settings) / worthwhile_samples(settings);
  return std::max(usual, (pixels + kMostRecorded - 1) / kMostRecorded);
}

}  // namespace

bool looks_up(const RenderSettings& settings) {
  if (settings.max_depth < 3 || (settings.for_denoising && settings.cache != Use::on)) return false;
  return uses(settings, settings.cache);
}

CacheFiller::CacheFiller(const RenderSettings& settings, float pixel_width)
    : width_(static_cast<std::uint64_t>(settings.width)),
      pixels_(width_ * static_cast<std::uint64_t>(settings.height)),
      pixels_per_record_(pixels_per_record(settings)),
      samples_(usual_generation_size(settings)),
      cell_side_(kCellInPixels * pixel_width * std::sqrt(static_cast<float>(pixels_per_record_) / kPixelsPerRecord)) {}

std::uint64_t CacheFiller::fill(std::uint32_t generation, const Geometry& geometry, std::optional<RadianceCache>& cache,
                                const Record& record) const {
  const std::uint64_t chosen = (pixels_ + pixels_per_record_ - 1) / pixels_per_record_;
  std::vector<std::optional<RadianceRecord>> found(chosen * samples_);
  std::vector<std::uint64_t> rays(chosen);
  parallel_for(chosen, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const std::uint32_t one =
          hash_combine(generation, static_cast<std::uint32_t>(c)) % static_cast<std::uint32_t>(pixels_per_record_);
      const std::uint64_t pixel = std::min(c * pixels_per_record_ + one, pixels_ - 1);
      for (std::uint32_t first = 0; first < samples_; first += kBatch)
        rays[c] += record(static_cast<int>(pixel % width_), static_cast<int>(pixel / width_),
                          generation * samples_ + first, std::span(found).subspan(c * samples_ + first, kBatch));
    }
  });
  std::vector<RadianceRecord> records;
  for (const std::optional<RadianceRecord>& r : found)
    if (r) records.push_back(*r);
  const float width = std::pow(static_cast<float>(generation + 1), kShrinking);
  const auto offset = [&](std::uint32_t axis) { return to_unit_float(hash_combine(generation, axis)); };
  cache.emplace(records, geometry, cell_side_ * width, 1 / width, Vec3(offset(0), offset(1), offset(2)));
  return std::accumulate(rays.begin(), rays.end(), cache->rays());
}

}  // namespace etendue
