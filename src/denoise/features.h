#pragma once

#include "denoise/denoise.h"
#include "denoise/regression.h"

namespace etendue {

/// Albedo, normal and depth of a picture, with less noise: at edges, and where they are seen through a lens. Depth
/// becomes 1 / (1 + depth / median), so that far is 0 and its range does not matter.
Features filtered_features(const NoisyPicture& picture);

}  // namespace etendue
