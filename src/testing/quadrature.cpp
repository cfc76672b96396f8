#include "testing/quadrature.h"

#include <cmath>

namespace etendue {
namespace {

/// Gauss–Legendre with three points on [−1, 1].
constexpr double kNode[3] = {-0.7745966692414834, 0, 0.7745966692414834};
constexpr double kWeight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};

double estimate(const std::function<double(double)>& f, double a, double b) {
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += kWeight[i] * f(middle + half * kNode[i]);
  return sum * half;
}

double estimate(const std::function<double(double, double)>& f, const Box2& box) {
  const auto inner = [&](double y) { return estimate([&](double x) { return f(x, y); }, box.x0, box.x1); };
  return estimate(std::function<double(double)>(inner), box.y0, box.y1);
}

double refine(const std::function<double(double)>& f, double a, double b, double coarse, double tolerance, int depth) {
  const double middle = 0.5 * (a + b);
  const double left = estimate(f, a, middle), right = estimate(f, middle, b);
  if (depth <= 0 || std::abs(left + right - coarse) < tolerance) return left + right;
  return refine(f, a, middle, left, 0.5 * tolerance, depth - 1) +
         refine(f, middle, b, right, 0.5 * tolerance, depth - 1);
}

double refine(const std::function<double(double, double)>& f, const Box2& box, double coarse, double tolerance,
              int depth) {
  const double x = 0.5 * (box.x0 + box.x1), y = 0.5 * (box.y0 + box.y1);
  const Box2 quarters[4] = {
      {box.x0, x, box.y0, y}, {x, box.x1, box.y0, y}, {box.x0, x, y, box.y1}, {x, box.x1, y, box.y1}};
  double fine[4], sum = 0;
  for (int i = 0; i < 4; ++i) sum += fine[i] = estimate(f, quarters[i]);
  if (depth <= 0 || std::abs(sum - coarse) < tolerance) return sum;
  sum = 0;
  for (int i = 0; i < 4; ++i) sum += refine(f, quarters[i], fine[i], 0.5 * tolerance, depth - 1);
  return sum;
}

}  // namespace

double integrate(const std::function<double(double)>& f, double a, double b, double tolerance) {
  constexpr int kPieces = 16;  // so that a narrow peak between the first points is not overlooked
  double sum = 0;
  for (int i = 0; i < kPieces; ++i) {
    const double low = a + (b - a) * i / kPieces, high = a + (b - a) * (i + 1) / kPieces;
    sum += refine(f, low, high, estimate(f, low, high), tolerance / kPieces, 20);
  }
  return sum;
}

double integrate(const std::function<double(double, double)>& f, const Box2& box, double tolerance, int max_depth) {
  return refine(f, box, estimate(f, box), tolerance, max_depth);
}

}  // namespace etendue
