#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/geometry.h"
#include "math/spectrum.h"
#include "math/vec.h"

namespace etendue {

/// A diffuse surface, or a place in a medium, and one estimate of the light that it scatters: all of it, but in scenes
/// with media what light sampling finds there, which is added where it is looked up.
struct RadianceRecord {
  Point3 position{0, 0, 0};
  Vec3 normal{0, 0, 1};  ///< unit, shading normal on the lit side; in a medium: to where the light is scattered
  float turns = 0;       ///< steps to the unit in which `normal` is told apart
  int bounces_left = 0;  ///< that the light counted may have taken; kUnlimitedDepth: any number
  std::uint32_t medium = kNone;
  /// Scattered radiance / reflectance, or / albedo: of all light, but what came to this surface by way of delta lobes
  /// alone from a lamp or a surface where photons are, which is the second.
  Spectrum radiance{}, caustics{};
};

/// Light between diffuse surfaces, looked up where a path has been scattered widely instead of following it on (Ward et
/// al. 1988 for the idea, Binder et al. 2018, "Path Space Filtering", for the hashed cells): means of records over
/// cells of position and normal. Coarser cells serve where records are few; none serves if something stands between its
/// records.
class RadianceCache {
 public:
  struct Light {
    Spectrum radiance, caustics;
  };

 private:
  static constexpr int kLevels = 3;
  static constexpr std::size_t kFewest = 8;  ///< records that make a cell's mean worth using
  struct Cell {
    Light light;
    bool open = false;      ///< nothing stands within it; else wider cells are no better
    std::uint32_t key = 0;  ///< 0: empty
  };
  using Keyed = std::pair<std::uint64_t, std::uint32_t>;  ///< a record's key and number

 public:
  /// Beside the records, while it is made: on each level, up to four cells for kFewest records.
  static constexpr std::size_t kBytesPerRecord = kLevels * (sizeof(Keyed) + 4 * sizeof(Cell) / kFewest);

  RadianceCache() = default;
  /// Cells of the finest level have sides of `side` metres, those of each other twice as wide ones; `offset`, in [0,
  /// 1)³, moves their grid by so much of the widest. Directions are told apart in `sharpness` times as many steps as
  /// the records say.
  RadianceCache(std::span<const RadianceRecord> records, const Geometry& geometry, float side, float sharpness,
                const Vec3& offset);

  /// Mean of the records like this one (whose radiance does not matter), if there are enough of them.
  const Light* find(const RadianceRecord& like) const;
  float side() const { return side_; }
  std::uint64_t rays() const { return rays_; }  ///< traced to build it

 private:
  struct Level {
    std::vector<Cell> cells;  ///< open addressing; a power of two
    const Cell* find(std::uint64_t key) const;
    void insert(std::uint64_t key, const Cell& cell);
  };
  std::uint64_t key(const RadianceRecord& record, int level) const;
  std::uint64_t fill(int level, std::span<const RadianceRecord> records, const Geometry& geometry);

  float side_ = 0, sharpness_ = 1;
  Vec3 offset_{0, 0, 0};
  std::array<Level, kLevels> levels_;
  std::uint64_t rays_ = 0;
};

}  // namespace etendue
