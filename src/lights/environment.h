#pragma once

#include <span>

#include "image/image.h"
#include "math/spectrum.h"
#include "math/transform.h"
#include "math/vec.h"
#include "sampling/cumulative_rows.h"

namespace etendue {

/// Piecewise-constant distribution over a latitude–longitude map's texels with probability ∝ luminance · sin θ: a row
/// by the marginal, then a column given the row; uniform within the texel. Sums are doubles, so that one-texel suns and
/// huge maps stay exact. A map without any light is sampled uniformly in solid angle.
class TexelDistribution {
 public:
  TexelDistribution() = default;
  explicit TexelDistribution(const Image& map);

  struct Sample {
    Vec2 uv;    ///< in [0,1)², (0,0) the upper left corner of the map
    float pdf;  ///< per unit area of the uv square; integrates to 1
  };
  Sample sample(Vec2 u) const;
  /// samples[i] for u[i], at most kMostAtOnce: they wait for memory together.
  static constexpr int kMostAtOnce = 16;
  void sample(std::span<const Vec2> u, std::span<Sample> samples) const;
  float pdf(Vec2 uv) const;

  int width() const { return width_; }
  int height() const { return height_; }
  /// Cumulative probability up to and including a row, and up to and including a column within a row.
  float row_cdf(int row) const { return row_cdf_.at(0, row); }
  float column_cdf(int row, int column) const { return column_cdf_.at(row, column); }

 private:
  int width_ = 0, height_ = 0;
  CumulativeRows row_cdf_, column_cdf_;
};

/// Solid angle of row `row` of a grid of `height` rows over the sphere, in units of 2π: cos θ_top − cos θ_bottom.
double row_solid_angle(int row, int height);

/// Where a map's rows stand between the zenith (v = 0) and the nadir (v = 1).
enum class MapRows {
  centered,      ///< row i at v = (i + ½) / height, constant beyond the first and the last
  pole_to_pole,  ///< the first row is the zenith, the last the nadir (Mitsuba's convention)
};

/// The mean of the bilinear lookup over the cells of a grid: what to build the distribution of, so that every direction
/// from which light comes has a density above zero (the lookup reaches into black neighbours). As many columns as the
/// map; as many rows, or with pole_to_pole one fewer, each between two of the map's.
Image lookup_means(const Image& map, MapRows rows);

/// What is left of lookup means for light samples to do where BSDF samples find the same light and the two are
/// weighted: what exceeds the mean over the sphere (Karlík et al. 2019, "MIS Compensation: Optimizing Sampling
/// Techniques in Multiple Importance Sampling", eq. 14 with equal shares). Its distribution misses directions from
/// which light comes.
Image compensated(const Image& means);

/// What cleaning a map found.
struct MapRepairs {
  std::size_t invalid = 0;  ///< NaN, infinite or negative texels, set to 0
  bool black = false;       ///< nothing but black is left
};

/// Replaces NaN, infinite and negative channels by 0.
MapRepairs repair_map(Image& map);

/// How directions and map coordinates correspond.
struct MapOrientation {
  float rotation = 0;     ///< radians about +y, counter-clockwise seen from above
  bool mirrored = false;  ///< the CGL profile's mapping

  MapRows rows() const { return mirrored ? MapRows::centered : MapRows::pole_to_pole; }
};
/// Standard: u = atan2(x, −z) / 2π wrapped to [0,1), v = acos(y) / π. Mirrored: u = (atan2(−z, x) + π) / 2π.
Vec2 direction_to_uv(const MapOrientation& orientation, const Vec3& direction);
Vec3 uv_to_direction(const MapOrientation& orientation, Vec2 uv);

/// Radiance of the map at uv: bilinear, columns at their centres and wrapping in u, rows as told.
Spectrum lookup_bilinear(const Image& map, Vec2 uv, MapRows rows);

}  // namespace etendue
