#pragma once

#include <functional>

namespace etendue {

/// ∫ f(x) dx from `a` to `b`. Halves the interval until two estimates differ by less than `tolerance` (absolute), 20
/// times at the most.
double integrate(const std::function<double(double)>& f, double a, double b, double tolerance = 1e-9);

struct Box2 {
  double x0, x1, y0, y1;
};

/// ∫∫ f(x, y) dx dy over `box`. Quarters it until two estimates differ by less than `tolerance` (absolute), `max_depth`
/// times at the most: at a jump of f the error is about jump · area · 2^(−1.5 max_depth).
double integrate(const std::function<double(double, double)>& f, const Box2& box, double tolerance, int max_depth = 7);

}  // namespace etendue
