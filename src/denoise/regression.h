#pragma once

#include "denoise/patch_distance.h"

namespace etendue {

/// What colours are explained by: albedo (3), normal (3) and depth, each of order 1.
inline constexpr int kFeatures = 7;
using Features = std::array<Plane, kFeatures>;

/// How many ways of filtering there are to choose from.
inline constexpr int kBandwidths = 2;

/// How alike pixels are is read off a picture whose noise is independent of that which is filtered. They count by
/// exp(−d²/k²): d from PatchDistances, k is called the bandwidth.
struct Guide {
  const ColorPlanes& value;
  const ColorPlanes& variance;
};

/// Means of resembling pixels (non-local means, Buades, Coll and Morel 2005, with the distance of Rousselle et al.).
ColorPlanes weighted_mean(const ColorPlanes& color, const Guide& guide, const Window& window, float bandwidth);

/// Around every pixel, colours are fitted to the features by weighted least squares of first order, with the same
/// weights; each pixel is then the weighted mean of what the fits around its neighbours say of it (Bitterli et al.
/// 2016, "Nonlinearly Weighted First-order Regression for Denoising Monte Carlo Renderings", sections 4 and 5). One
/// result for each bandwidth.
std::array<ColorPlanes, kBandwidths> regressions(const ColorPlanes& color, const Features& features, const Guide& guide,
                                                 const Window& window,
                                                 const std::array<float, kBandwidths>& bandwidths);

}  // namespace etendue
