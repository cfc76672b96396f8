#pragma once

#include <span>

#include "image/image.h"

namespace etendue {

/// Blue (0: few samples) over green (½) to red (1: many); t is clamped, NaN counts as 0. Linear Rec. 709.
Spectrum rate_color(float t);

/// Black over violet and orange to pale yellow: lightness grows evenly with t in [0, 1], so that more looks like more,
/// in grey too. t is clamped, NaN counts as 0. Linear Rec. 709.
Spectrum heat_color(float t);

/// A picture of `values` (width × height of them, row 0 on top) in heat_color.
Image heat_map(std::span<const float> values, int width, int height);

}  // namespace etendue
