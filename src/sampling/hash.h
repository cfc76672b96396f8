#pragma once

#include <cstdint>

namespace etendue {

/// Bijective 32-bit mixer with low bias (Wellons 2018, "Prospecting for Hash Functions", lowbias32).
constexpr std::uint32_t mix_bits(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

constexpr std::uint32_t hash_combine(std::uint32_t a, std::uint32_t b) {
  return mix_bits(a ^ (mix_bits(b) + 0x9e3779b9u + (a << 6) + (a >> 2)));
}

/// Uniform in [0,1) from 32 random bits: the 24 highest, so that every value is exact.
constexpr float to_unit_float(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

}  // namespace etendue
