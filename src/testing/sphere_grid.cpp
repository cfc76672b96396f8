#include "testing/sphere_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "testing/quadrature.h"

namespace etendue {

// A direction at the angle θ from the axis has the ring coordinate x = t / (t + focus) in [0, 1], t = tan(θ/2).

SphereGrid::SphereGrid(const Vec3& axis, double focus, int rings, int sectors)
    : frame_(Frame::from_normal(axis)), focus_(focus), rings_(rings), sectors_(sectors) {}

std::size_t SphereGrid::cell(const Vec3& direction) const {
  const Vec3 w = frame_.to_local(direction);
  const double sine = std::hypot(w.x, w.y), cosine = w.z;
  const double t = cosine > 0 ? sine / (1 + cosine) : (1 - cosine) / sine;
  const double x = 1 / (1 + focus_ / t);
  const double y = std::atan2(w.y, w.x) / (2 * std::numbers::pi) + 0.5;
  const int ring = std::clamp(static_cast<int>(x * rings_), 0, rings_ - 1);
  const int sector = std::clamp(static_cast<int>(y * sectors_), 0, sectors_ - 1);
  return static_cast<std::size_t>(ring) * sectors_ + sector;
}

std::vector<double> SphereGrid::integrals(const Density& density, double tolerance) const {
  const auto integrand = [&](double x, double y) {
    const double t = focus_ * x / (1 - x), phi = (y - 0.5) * 2 * std::numbers::pi;
    const double t2 = t * t, sine = 2 * t / (1 + t2), cosine = (1 - t2) / (1 + t2);
    const Vec3 local(static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
                     static_cast<float>(cosine));
    // dω = sin θ dθ dφ with dθ = 2 dt / (1 + t²), dt = focus dx / (1 − x)².
    const double jacobian = 2 * sine / (1 + t2) * focus_ / ((1 - x) * (1 - x)) * 2 * std::numbers::pi;
    return density(frame_.to_world(local)) * jacobian;
  };
  constexpr int kPieces = 5;  // along each side of a cell: a jump between the first points is not overlooked
  const int rows = rings_ * kPieces, columns = sectors_ * kPieces;
  std::vector<double> out(size());
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      out[static_cast<std::size_t>(row / kPieces) * sectors_ + column / kPieces] +=
          integrate(integrand,
                    Box2{static_cast<double>(row) / rows, static_cast<double>(row + 1) / rows,
                         static_cast<double>(column) / columns, static_cast<double>(column + 1) / columns},
                    tolerance / (kPieces * kPieces));
  return out;
}

double integrate_sphere(const SphereGrid& grid, const SphereGrid::Density& density, double tolerance) {
  const std::vector<double> cells = grid.integrals(density, tolerance);
  return std::accumulate(cells.begin(), cells.end(), 0.0);
}

ChiSquareTest direction_test(const SphereGrid& grid, int count, const DirectionSampler& sample,
                             const SphereGrid::Density& density) {
  std::vector<double> expected = grid.integrals(density, 1.0 / count);  // to a fraction of a direction
  expected.push_back(std::max(1 - std::accumulate(expected.begin(), expected.end(), 0.0), 0.0));
  for (double& e : expected) e *= count;
  std::vector<double> observed(expected.size());
  for (int i = 0; i < count; ++i) {
    const std::optional<Vec3> direction = sample();
    ++observed[direction ? grid.cell(*direction) : observed.size() - 1];
  }
  return chi_square_test(observed, expected);
}

}  // namespace etendue
