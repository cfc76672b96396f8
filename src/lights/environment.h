#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"
#include "math/spectrum.h"
#include "math/transform.h"
#include "math/vec.h"

namespace etendue {

/// Piecewise-constant distribution over a latitude–longitude map's texels with probability ∝ luminance · sin θ: a row by the marginal, then
/// a column given the row; uniform within the texel. Sums are doubles, so that one-texel suns and huge maps stay exact.
/// A map without any light is sampled uniformly in solid angle.
class TexelDistribution {
 public:
  TexelDistribution() = default;
  explicit TexelDistribution(const Image& map);

  struct Sample {
    Vec2 uv;     ///< in [0,1)², (0,0) the upper left corner of the map
    float pdf;   ///< per unit area of the uv square; integrates to 1
  };
  Sample sample(Vec2 u) const;
  float pdf(Vec2 uv) const;

  int width() const { return width_; }
  int height() const { return height_; }
  /// Cumulative probability up to and including a row, and up to and including a column within a row.
  float row_cdf(int row) const { return row_cdf_[row]; }
  float column_cdf(int row, int column) const { return column_cdf_[static_cast<std::size_t>(row) * width_ + column]; }

 private:
  int width_ = 0, height_ = 0;
  std::vector<float> row_cdf_;     ///< height_ values, the last is 1
  std::vector<float> column_cdf_;  ///< width_ values a row, the last of each is 1
  // Where to start looking for u in a CDF of n values: the first index whose value exceeds ⌊u n⌋ / n (Chen and Asau 1974), at
  // most 65535. Small, as is everything here: sampling a large map waits for memory.
  std::vector<std::uint16_t> row_guide_;
  std::vector<std::uint16_t> column_guide_;
};

/// Where a map's rows stand between the zenith (v = 0) and the nadir (v = 1).
enum class MapRows {
  centered,      ///< row i at v = (i + ½) / height, constant beyond the first and the last
  pole_to_pole,  ///< the first row is the zenith, the last the nadir (Mitsuba's convention)
};

/// The mean of the bilinear lookup over the cells of a grid: what to build the distribution of, so that every direction from which light
/// comes has a density above zero (the lookup reaches into black neighbours). As many columns as the map; as many rows, or with
/// pole_to_pole one fewer, each between two of the map's.
Image lookup_means(const Image& map, MapRows rows);

/// What cleaning a map found.
struct MapRepairs {
  std::size_t invalid = 0;   ///< NaN, infinite or negative texels, set to 0
  bool black = false;        ///< nothing but black is left
};

/// Replaces NaN, infinite and negative channels by 0.
MapRepairs repair_map(Image& map);

/// How directions and map coordinates correspond.
struct MapOrientation {
  float rotation = 0;       ///< radians about +y, counter-clockwise seen from above
  bool mirrored = false;    ///< the CGL profile's mapping

  MapRows rows() const { return mirrored ? MapRows::centered : MapRows::pole_to_pole; }
};
/// Standard: u = atan2(x, −z) / 2π wrapped to [0,1), v = acos(y) / π. Mirrored: u = (atan2(−z, x) + π) / 2π.
Vec2 direction_to_uv(const MapOrientation& orientation, const Vec3& direction);
Vec3 uv_to_direction(const MapOrientation& orientation, Vec2 uv);

/// Radiance of the map at uv: bilinear, columns at their centres and wrapping in u, rows as told.
Spectrum lookup_bilinear(const Image& map, Vec2 uv, MapRows rows);

}  // namespace etendue
