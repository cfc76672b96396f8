#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "denoise/denoise.h"
#include "image/image.h"
#include "math/spectrum.h"
#include "math/vec.h"
#include "render/cascades.h"

namespace etendue {

/// What one camera path brings back.
struct PixelSample {
  Spectrum radiance;
  Spectrum albedo;       ///< of the first surface
  Vec3 normal{0, 0, 0};  ///< of the first surface, shading, facing the camera; zero without one
  float depth = 0;       ///< along the camera's axis; 0 without surface
  float weight = 1;      ///< of the radiance in the pixel's mean: below 0 in a reconstruction filter's negative lobes
};

/// Sums and counts of a pixel's samples, added in the order of the samples: averages are formed only when the picture
/// is asked for, so that partial renders can be merged exactly.
struct PixelSums {
  double sum[3] = {0, 0, 0};
  double sum_of_squares[3] = {0, 0, 0};
  double luminance_squares = 0;
  double albedo[3] = {0, 0, 0};
  double normal[3] = {0, 0, 0};
  double depth = 0;
  std::uint32_t hits = 0;     ///< samples that met a surface
  std::uint32_t samples = 0;  ///< all samples
  bool finished = false;      ///< gets no more

  void add(const PixelSample& sample);
  double mean_luminance() const;
  /// σ/√n of the luminance; ∞ before two samples.
  double luminance_error() const;
  /// Of one sample in a channel; 0 before two samples.
  double variance(int channel) const;
  /// What was added since `earlier`.
  PixelSums since(const PixelSums& earlier) const;
};

/// The picture in the making.
class Film {
 public:
  /// With `keeps_half`, what the first half of the samples gave is summed on its own as well, for denoising. With
  /// `doubts_outliers`, lone bright samples count for less in the beauty.
  Film(int width, int height, bool keeps_half = false, bool doubts_outliers = false)
      : width_(width),
        pixels_(static_cast<std::size_t>(width) * height),
        first_half_(keeps_half ? pixels_.size() : std::size_t{0}),
        cascades_(doubts_outliers ? Cascades(width, height) : Cascades()) {}

  int width() const { return width_; }
  int height() const { return static_cast<int>(pixels_.size()) / width_; }
  PixelSums& at(int x, int y) { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }
  const PixelSums& at(int x, int y) const { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }
  const std::vector<PixelSums>& pixels() const { return pixels_; }
  bool keeps_half() const { return !first_half_.empty(); }
  /// Adds samples to a pixel; in_first_half of them, the first ones, belong to the first half.
  void add(int x, int y, std::span<const PixelSample> samples, std::size_t in_first_half);

  Image beauty() const;
  /// The beauty with the channels that RenderSession::snapshot names.
  Picture picture() const;
  /// Nothing unless it keeps the first half, and has kMinimumToDenoise samples of each pixel.
  std::optional<NoisyPicture> noisy_picture() const;
  /// Mean over pixels of σ/√n / (mean + 0.01), luminance; ∞ before two samples.
  double noise() const;
  /// How many pixels no sample has reached.
  std::size_t unsampled_pixels() const;

 private:
  int width_;
  std::vector<PixelSums> pixels_;
  std::vector<PixelSums> first_half_;  ///< empty unless kept
  Cascades cascades_;                  ///< empty unless outliers are doubted
};

}  // namespace etendue
