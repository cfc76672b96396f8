#pragma once

#include <vector>

#include "image/image.h"

namespace etendue {

/// How much an observer who flips between two pictures sees them differ.
struct FlipError {
  std::vector<float> map;  ///< one value a pixel, row 0 on top: 0 (no difference) to 1 (the largest there can be)
  double mean = 0;
};

/// ꟻLIP for display-referred pictures (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images").
/// Values outside [0, 1], NaN included, are clamped as a screen would. `pixels_per_degree` of visual angle: 67 is a 0.7
/// m wide 3840-pixel screen seen from 0.7 m. Throws Error(Failure::usage) if the sizes differ.
FlipError flip_error(const Image& image, const Image& reference, float pixels_per_degree = 67);

}  // namespace etendue
