#pragma once

#include <array>
#include <vector>

#include "math/spectrum.h"

namespace etendue {

/// Keeps apart what bright samples gave to each pixel, to tell how much of it may be chance (after Zirr, Hanika and
/// Dachsbacher 2018, "Re-weighting Firefly Samples for Improved Finite-Sample Monte Carlo Estimates", with samples
/// counted instead of shared out). Each cascade takes samples up to eight times as bright as the one before. Its light
/// counts in full where a pixel and its eight neighbours have kTrusted samples as bright, and not at all where they
/// have one. Of all that has a probability samples become more, so that less and less is left out.
class Cascades {
 public:
  Cascades() = default;
  Cascades(int width, int height) : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height) {}

  bool empty() const { return pixels_.empty(); }
  /// Adds one sample of a pixel.
  void add(int x, int y, const Spectrum& sample);
  /// Of the sum of a pixel's samples, what is not to count.
  Spectrum doubtful(int x, int y) const;

 private:
  struct Cascade {
    Spectrum sum;
    float samples = 0;
  };
  static constexpr int kCascades = 12;
  using Pixel = std::array<Cascade, kCascades>;  ///< the darkest first
  const Pixel& at(int x, int y) const { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }
  float samples_like(int x, int y, int cascade) const;

  int width_ = 0, height_ = 0;
  std::vector<Pixel> pixels_;
};

}  // namespace etendue
