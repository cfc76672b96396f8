#include "sampling/sampler.h"

#include <bit>

#include "sampling/hash.h"

namespace etendue {
namespace {

// The same integer arithmetic for every processor, so the widest registers may be used without changing a bit of the
// result.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define ETENDUE_WIDEST_SIMD __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define ETENDUE_WIDEST_SIMD
#endif

inline std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x << 16) | (x >> 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  x = ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
  return x;
}

/// Hash in which each bit depends on lower bits only: an Owen scramble of a bit-reversed number (Laine and Karras 2011;
/// constants of Vegdahl 2021, "Building a Better LK Hash").
inline std::uint32_t owen_hash(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Second Sobol dimension, bit-reversed: Pascal's triangle modulo 2 applied to the index, as a sum over supersets of
/// bit positions.
inline std::uint32_t pascal_transform(std::uint32_t x) {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  x ^= (x >> 16) & 0x0000ffffu;
  return x;
}

/// Shuffled and scrambled Sobol pairs (Burley 2020, "Practical Hash-based Owen Scrambling", section 4). Dimension 0 is
/// the reversed index, so its reversals cancel against those of the scramble.
ETENDUE_WIDEST_SIMD
void sobol_points(std::uint32_t seed, std::uint32_t first, int count, float* __restrict u, float* __restrict v) {
  const std::uint32_t seed_index = mix_bits(seed), seed_u = mix_bits(seed + 0x68bc21ebu),
                      seed_v = mix_bits(seed + 0x02e5be93u);
  for (int i = 0; i < count; ++i) {
    const std::uint32_t index =
        reverse_bits(owen_hash(reverse_bits(first + static_cast<std::uint32_t>(i)), seed_index));
    const std::uint32_t x = reverse_bits(owen_hash(index, seed_u));
    const std::uint32_t y = reverse_bits(owen_hash(pascal_transform(index), seed_v));
    u[i] = static_cast<float>(static_cast<std::int32_t>(x >> 8)) * 0x1p-24f;
    v[i] = static_cast<float>(static_cast<std::int32_t>(y >> 8)) * 0x1p-24f;
  }
}

ETENDUE_WIDEST_SIMD
void independent_points(std::uint32_t seed, std::uint32_t first, int count, float* __restrict u, float* __restrict v) {
  for (int i = 0; i < count; ++i) {
    const std::uint32_t x = mix_bits(mix_bits(first + static_cast<std::uint32_t>(i)) ^ seed);
    const std::uint32_t y = mix_bits(x + 0x9e3779b9u);
    u[i] = static_cast<float>(static_cast<std::int32_t>(x >> 8)) * 0x1p-24f;
    v[i] = static_cast<float>(static_cast<std::int32_t>(y >> 8)) * 0x1p-24f;
  }
}

/// Side of the squares within which pixels are spread together.
constexpr std::uint32_t kSquare = 1 << 8;
constexpr int kPlaceBits = 16;

/// Bit i of x < kSquare to place 2i.
constexpr std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 4) & 0x0f0fu;
  x = (x | x << 2) & 0x3333u;
  return (x | x << 1) & 0x5555u;
}

}  // namespace

PixelSampler::PixelSampler(SamplerKind kind, std::uint64_t seed, std::uint32_t x, std::uint32_t y,
                           std::uint32_t samples)
    : kind_(kind) {
  const std::uint32_t seed_hash =
      hash_combine(mix_bits(static_cast<std::uint32_t>(seed) + 0x165667b1u), static_cast<std::uint32_t>(seed >> 32));
  if (kind != SamplerKind::sobol || samples == 0 || samples > kFewSamples) {
    hash_ = hash_combine(hash_combine(seed_hash, x), y);
    return;
  }
  samples_ = samples;
  place_ = spread_bits(x % kSquare) | spread_bits(y % kSquare) << 1;
  hash_ = hash_combine(hash_combine(seed_hash, x / kSquare), y / kSquare);
}

void PixelSampler::points(std::uint64_t dimension, std::uint64_t first, int count, float* u, float* v,
                          int per_sample) const {
  // Each pixel has a part of the sequence, as long as it needs.
  const auto needed = static_cast<int>(std::bit_width(samples_ * static_cast<std::uint64_t>(per_sample) - 1));
  const bool alone = samples_ == 0 || needed > 32 - kPlaceBits;
  const int bits = alone ? 32 : needed;
  const std::uint64_t size = std::uint64_t{1} << bits, in_part = first & (size - 1), left = size - in_part;
  const auto part = static_cast<std::uint32_t>(first >> bits);
  const auto index = static_cast<std::uint32_t>(alone ? in_part : place_ * size + in_part);
  if (left < static_cast<std::uint64_t>(count)) {
    const int here = static_cast<int>(left);
    points(dimension, first, here, u, v, per_sample);
    points(dimension, first + left, count - here, u + here, v + here, per_sample);
    return;
  }
  std::uint32_t seed = hash_combine(
      hash_, static_cast<std::uint32_t>(dimension) + 0x9e3779b1u * static_cast<std::uint32_t>(dimension >> 32));
  if (alone && samples_ != 0) seed = hash_combine(seed, place_);
  if (part != 0) seed = hash_combine(seed, part);
  if (kind_ == SamplerKind::sobol)
    sobol_points(seed, index, count, u, v);
  else
    independent_points(seed, index, count, u, v);
}

}  // namespace etendue
