#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

/// Angles in turns (1 turn = 2π), where the ends of the axes are exact. Polynomials near the minimax ones, as precise
/// as floats are, and without the branches and the reduction by π that make the library's functions slow.
namespace etendue {

struct SinCos {
  float sin, cos;
};

/// Sine and cosine of an angle of at most a million turns; within 2·10⁻⁷.
inline SinCos sin_cos_of_turns(float turns) {
  const int quarter = static_cast<int>(turns * 4 + std::copysign(0.5f, turns));
  const float t = turns - 0.25f * static_cast<float>(quarter), z = t * t;  // t within ±1/8, exact
  const float s = t * (6.28318529f + z * (-41.3416626f + z * (81.5925429f + z * -75.4016127f)));
  const float c = 1 + z * (-19.7392087f + z * (64.9393161f + z * (-85.4428447f + z * 59.2201689f)));
  const auto bits_s = std::bit_cast<std::uint32_t>(s), bits_c = std::bit_cast<std::uint32_t>(c);
  const auto q = static_cast<std::uint32_t>(quarter), swap = 0u - (q & 1u), difference = (bits_s ^ bits_c) & swap;
  return {std::bit_cast<float>(bits_s ^ difference ^ ((q & 2u) << 30)),
          std::bit_cast<float>(bits_c ^ difference ^ (((q + 1) & 2u) << 30))};
}

/// The angle of the point (x, y), counter-clockwise from +x, between −½ and ½; 0 for the origin. Within 3·10⁻⁸, and for
/// small angles within 10⁻⁷ of itself.
inline float turns_of(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const bool steep = ay > ax;
  const float larger = steep ? ay : ax, smaller = steep ? ax : ay;
  const float q = larger > 0 ? smaller / larger : 0.0f, z = q * q;
  float p = 0.00044026769f;
  for (const float c : {-0.00250370606f, 0.00670641108f, -0.01186795305f, 0.01689966174f, -0.0225964970f,
                        0.03181805255f, -0.05305117561f, 0.1591549402f})
    p = c + p * z;
  const float octant = q * p;
  const float quadrant = steep ? 0.25f - octant : octant;
  return std::copysign(std::signbit(x) ? 0.5f - quadrant : quadrant, y);
}

}  // namespace etendue
