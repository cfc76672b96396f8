#pragma once

#include <cstdint>

#include "math/vec.h"

namespace etendue {

enum class SamplerKind {
  sobol,        ///< Owen-scrambled Sobol pairs, padded: well spread over the samples of a pixel, for any count of them
  independent,  ///< uniform random numbers
};

/// The random numbers of one pixel. A value is a pure function of (seed, pixel, dimension, sample index): nothing
/// depends on the order in which samples are drawn, nor on threads. A "dimension" names one decision along a path (the
/// lens, the BSDF at bounce 2, …); each has its own shuffling of the samples, so that decisions are independent of each
/// other and each is well stratified by itself.
class PixelSampler {
 public:
  /// `samples`: of a pixel, if that is known and at most kFewSamples: then neighbouring pixels' points are well spread
  /// together too. Errors of the same sign keep away from each other, and the eye takes what is left for less (Ahmed
  /// and Wonka 2020, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of
  /// Pixels").
  PixelSampler(SamplerKind kind, std::uint64_t seed, std::uint32_t x, std::uint32_t y, std::uint32_t samples = 0);
  static constexpr std::uint32_t kFewSamples = 256;

  /// For samples first, first+1, … writes `count` points of [0,1)² to u[], v[]: coordinates in [0, 1 − 2⁻²⁴]. Sequences
  /// are well spread for 2³² samples; the next 2³² begin another. `per_sample`: where each of the pixel's samples takes
  /// so many of this dimension.
  void points(std::uint64_t dimension, std::uint64_t first, int count, float* u, float* v, int per_sample = 1) const;
  /// That of one sample.
  Vec2 point(std::uint64_t dimension, std::uint64_t index) const {
    Vec2 u;
    points(dimension, index, 1, &u.x, &u.y);
    return u;
  }

 private:
  SamplerKind kind_;
  std::uint32_t hash_;         ///< of the seed, and of the pixel or of those around it
  std::uint32_t samples_ = 0;  ///< of each of these; 0: the pixel is alone
  std::uint32_t place_ = 0;    ///< of the pixel among them
};

}  // namespace etendue
