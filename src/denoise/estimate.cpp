#include "denoise/estimate.h"

#include <algorithm>

namespace etendue {
namespace {

/// Errors are averaged over two boxes of this radius, one after the other.
constexpr int kErrorRadius = 6;

/// What counts as dark: relative errors are to brightness² plus this.
constexpr float kDark = 0.01f;

/// One colour of a pixel in both halves.
struct Values {
  float a, b;

  Values(const Halves& halves, int c, int x, int y) : a(halves.a[c].row(y)[x]), b(halves.b[c].row(y)[x]) {}
  float mean() const { return 0.5f * (a + b); }
};

/// Sums over the colours term(f, g, noisy), weighted for relative errors, and averages it around each pixel.
template <typename Term>
Plane mean_error(const Halves& f, const Halves& g, const Halves& noisy, const Term& term) {
  const Plane errors = make_plane(f.width(), f.height(), [&](int x, int y) {
    float sum = 0;
    for (int c = 0; c < 3; ++c) {
      const Values of_f(f, c, x, y);
      sum += term(of_f, Values(g, c, x, y), Values(noisy, c, x, y)) / (of_f.mean() * of_f.mean() + kDark);
    }
    return sum;
  });
  return box_blurred(box_blurred(errors, kErrorRadius), kErrorRadius);
}

}  // namespace

Halves best_mixture(const Halves& f, const Halves& g, const Halves& noisy, float reluctance) {
  // of (1 − α) f + α g: α = Q(f, f − g) / Q(f − g, f − g)
  const Plane numerator = mean_error(f, g, noisy, [](const Values& p, const Values& q, const Values& n) {
    const float step_a = p.a - q.a, step_b = p.b - q.b;
    return 0.5f * ((p.a - n.b) * step_a + (p.b - n.a) * step_b) - 0.25f * (p.a - p.b) * (step_a - step_b);
  });
  const Plane denominator = mean_error(f, g, noisy, [](const Values& p, const Values& q, const Values&) {
    const float step = p.mean() - q.mean();
    return step * step;
  });
  const Plane alpha = make_plane(f.width(), f.height(), [&](int x, int y) {
    const float d = denominator.row(y)[x];
    return d > 0 ? std::clamp((numerator.row(y)[x] / d - reluctance) / (1 - reluctance), 0.0f, 1.0f) : 0.0f;
  });
  const auto mixture = [&](const ColorPlanes& p, const ColorPlanes& q) {
    return make_color_planes(f.width(), f.height(), [&](int c, int x, int y) {
      const float t = alpha.row(y)[x];
      return (1 - t) * p[c].row(y)[x] + t * q[c].row(y)[x];
    });
  };
  return {mixture(f.a, g.a), mixture(f.b, g.b)};
}

}  // namespace etendue
