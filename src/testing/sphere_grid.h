#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "math/frame.h"
#include "testing/statistics.h"

namespace etendue {

/// Cells that cover the unit sphere: rings about an axis, cut by longitude. Half of the rings lie within 2·atan(focus)
/// of the axis, so that a narrow distribution is resolved as well as a wide one.
class SphereGrid {
 public:
  explicit SphereGrid(const Vec3& axis = {0, 0, 1}, double focus = 1, int rings = 16, int sectors = 24);

  std::size_t size() const { return static_cast<std::size_t>(rings_) * sectors_; }
  std::size_t cell(const Vec3& direction) const;

  /// ∫ density dω over each cell; density per solid angle, of order 1/(area it covers). `tolerance` is that of each
  /// cell's share.
  using Density = std::function<double(const Vec3&)>;
  std::vector<double> integrals(const Density& density, double tolerance = 1e-6) const;

 private:
  Frame frame_;
  double focus_;
  int rings_, sectors_;
};

/// ∫ density dω over the sphere.
double integrate_sphere(const SphereGrid& grid, const SphereGrid::Density& density, double tolerance = 1e-6);

/// One direction of a distribution, or none.
using DirectionSampler = std::function<std::optional<Vec3>()>;

/// That `count` directions follow `density`; what is missing of its integral to 1 is the probability of no direction.
ChiSquareTest direction_test(const SphereGrid& grid, int count, const DirectionSampler& sample,
                             const SphereGrid::Density& density);

}  // namespace etendue
