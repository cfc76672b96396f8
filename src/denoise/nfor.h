#pragma once

#include "denoise/denoise.h"
#include "denoise/estimate.h"

namespace etendue {

/// Either half of a picture filtered by regression on the features with the other half's weights (after Bitterli et al.
/// 2016), with two bandwidths, mixed for the least error. `clean`: the picture without outliers; `noisy`: with them.
Halves nfor(const NoisyPicture& picture, const Halves& clean, const Halves& noisy);

}  // namespace etendue
