#pragma once

#include <cmath>
#include <cstdint>

#include "math/vec.h"

namespace etendue {

/// As many independent uniform numbers as a loop of unknown length needs, where stratified ones would not help.
/// SplitMix64 (Steele, Lea and Flood 2014); the same seed gives the same numbers.
class RandomStream {
 public:
  RandomStream() = default;
  /// From a point of a PixelSampler: 48 bits of its own for each.
  explicit RandomStream(Vec2 seed)
      : state_(static_cast<std::uint64_t>(seed.x * 0x1p24f) << 24 | static_cast<std::uint64_t>(seed.y * 0x1p24f)) {}

  /// In [0, 1 − 2⁻²⁴].
  float next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1p-24f;
  }
  /// Exponentially distributed with mean 1.
  float exponential() { return -std::log1p(-next()); }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace etendue
