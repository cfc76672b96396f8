#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"
#include "math/spectrum.h"
#include "math/vec.h"

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
};

/// The picture in the making.
class Film {
 public:
  Film(int width, int height) : width_(width), pixels_(static_cast<std::size_t>(width) * height) {}

  int width() const { return width_; }
  int height() const { return static_cast<int>(pixels_.size()) / width_; }
  PixelSums& at(int x, int y) { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }
  const PixelSums& at(int x, int y) const { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }
  const std::vector<PixelSums>& pixels() const { return pixels_; }

  Image beauty() const;
  /// The beauty with the channels that RenderSession::snapshot names.
  Picture picture() const;
  /// Mean over pixels of σ/√n / (mean + 0.01), luminance; ∞ before two samples.
  double noise() const;
  /// How many pixels no sample has reached.
  std::size_t unsampled_pixels() const;

 private:
  int width_;
  std::vector<PixelSums> pixels_;
};

}  // namespace etendue
