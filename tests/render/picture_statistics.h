#pragma once

#include <cstddef>
#include <functional>

#include "image/compare.h"
#include "render/settings.h"
#include "testing/statistics.h"

namespace etendue {

/// What a part of a picture says about its mean. `error`: standard error, from the pixels' variances.
struct RegionMean {
  double mean = 0, error = 0;

  /// Probability of being this far from `expected` by chance; `tolerance` is what rounding may do.
  double p_value(double expected, double tolerance = 0) const;
  /// The same for the difference to another estimate of the same quantity.
  double p_value(const RegionMean& other, double tolerance = 0) const;
};

using PixelPredicate = std::function<bool(int x, int y)>;

/// Mean of one channel over a window, or of the luminance over the pixels of a region.
RegionMean region_mean(const SampledPicture& picture, const CropWindow& window, int channel);
RegionMean region_luminance(const SampledPicture& picture, const PixelPredicate& region);

/// For pictures whose pixels all have the same expectation: the pixels' spread is the error, whatever the sampler.
RunningMean over_pixels(const Image& image, int channel);

/// The z-test of means over square blocks of pixels in CIE XYZ: heavy tails of single pixels average out there.
///   z = (a − b) / √(Σ (v_a/n_a + v_b/n_b)) · pixels, with the block's mean variance of one sample at least
///   `variance_floor`;
/// a block-channel agrees if its two-sided p is above α = 1 − 0.99^(1/blocks) (Šidák).
struct BlockComparison {
  double alpha = 0;
  double agreeing_share = 0;
  double rms_z = 0;
  std::size_t tested = 0;
  Image p_values;  ///< one pixel a block
};
BlockComparison compare_in_blocks(const SampledPicture& a, const SampledPicture& b, int block,
                                  float variance_floor = 1e-4f);

/// The share of block-channels that has to agree (the conformance suite's).
inline constexpr double kAgreeingShare = 0.9975;

/// Whether two pictures are the same to the bit, in every channel.
::testing::AssertionResult identical(const Picture& a, const Picture& b);

}  // namespace etendue
