#pragma once

#include "denoise/plane.h"

namespace etendue {

/// The same picture twice: from either half of the samples.
struct Halves {
  ColorPlanes a, b;

  int width() const { return a[0].width(); }
  int height() const { return a[0].height(); }
};

/// For each pixel the mixture of `f` and `g` that is estimated to have the least error, relative to the brightness.
/// Each was computed from one half of the samples, so that the other half of `noisy` tells its error without bias: with
/// noise in b of variance v that f_a knows nothing of, E(f_a − b)(g_a − b) = E(f_a − μ)(g_a − μ) + v, and the error of
/// the mean of two halves follows from
///
///   (f_a + f_b)/2 · (g_a + g_b)/2 = (f_a g_a + f_b g_b)/2 − (f_a − f_b)(g_a − g_b)/4
///
/// The quadratic form is averaged around each pixel and its least value taken in closed form; v falls out. What is
/// found is itself uncertain: a share of g below `reluctance` (0 … 1) counts as none, and what is above rises to 1 with
/// it.
Halves best_mixture(const Halves& f, const Halves& g, const Halves& noisy, float reluctance = 0);

}  // namespace etendue
