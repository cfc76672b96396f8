#pragma once

#include <cstdint>
#include <random>

#include "math/vec.h"

namespace etendue {

/// Independent uniform random numbers, the same ones in every run.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In [0, 1 − 2⁻²⁴], like the renderer's own.
  float value() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
  float between(float low, float high) { return lerp(value(), low, high); }
  Vec2 point() {
    const float x = value();
    return {x, value()};
  }
  /// Uniform on the unit sphere.
  Vec3 direction() {
    const float z = between(-1, 1), phi = between(0, 2 * kPi), r = safe_sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace etendue
