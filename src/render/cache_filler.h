#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "render/radiance_cache.h"
#include "render/settings.h"

namespace etendue {

/// Paths that are recorded have random numbers of their own.
inline constexpr std::uint64_t kRecordSeed = 0x9e3779b97f4a7c15u;
/// What the cache knows is used where a path's directions are spread over so many sides of its cells.
inline constexpr float kSpreadInCells = 2;
/// Steps to the unit in which surfaces' normals are told apart.
inline constexpr float kNormalSteps = 2;

/// Whether to look up light at all: what neighbouring cells know is not independent, and light needs two bounces
/// between surfaces to be worth it.
bool looks_up(const RenderSettings& settings);

/// Chooses the pixels whose paths are recorded, and makes a generation's cache of what they find.
class CacheFiller {
 public:
  /// `pixel_width` is that of usual_pixel_width().
  CacheFiller(const RenderSettings& settings, float pixel_width);

  /// Of the first generation's finest cells, in metres; 0: there is nothing to look up.
  float cell_side() const { return cell_side_; }

  /// Follows paths of pixel (x, y), samples first, first + 1, …, each up to what it records. Returns the rays traced.
  using Record =
      std::function<std::uint64_t(int x, int y, std::uint32_t first, std::span<std::optional<RadianceRecord>> records)>;
  /// Makes `cache` that of a generation; the same for any number of threads. Returns the rays traced.
  std::uint64_t fill(std::uint32_t generation, const Geometry& geometry, std::optional<RadianceCache>& cache,
                     const Record& record) const;

 private:
  std::vector<RadianceRecord> collect(std::uint32_t generation, const Record& record, std::uint64_t& rays) const;

  std::uint64_t width_, pixels_;
  std::uint32_t samples_;  ///< of a pixel and generation
  std::uint64_t pixels_per_record_;
  float cell_side_;
};

}  // namespace etendue
