#pragma once

#include <cstdint>

/// The random numbers' dimensions: two for the camera, then a block for each bounce.
namespace etendue::dimension {

inline constexpr std::uint64_t kFilm = 0, kLens = 1;
inline constexpr std::uint64_t kBounceStride = std::uint64_t{1} << 33;  // room for two of each of 2³² lights
inline constexpr std::uint64_t kDirection = 2, kLobeAndRoulette = 3, kLightChoice = 4, kFreeFlight = 5, kLights = 6;
// Without media: directions that look for lights only.
inline constexpr std::uint64_t kMoreDirections = kBounceStride - 3, kMoreLobes = kBounceStride - 4;
inline constexpr std::uint64_t kTracking = kBounceStride - 1;   // seeds the loops through heterogeneous media
inline constexpr std::uint64_t kAirlight = kBounceStride - 2;   // which light a segment gathers, and where
inline constexpr std::uint64_t kBeam = kBounceStride - 4;       // a ray out of a lamp
inline constexpr std::uint64_t kBeamPoint = kBounceStride - 3;  // which lamp, and where on the ray
inline constexpr std::uint64_t kPart = kBounceStride - 1;       // of a surface whose irradiance is measured
inline constexpr std::uint64_t at(int bounce, std::uint64_t slot) {
  return static_cast<std::uint64_t>(bounce) * kBounceStride + slot;
}
/// Where a point on a light lies, and on which part of the light.
inline constexpr std::uint64_t position(std::uint64_t light) {
  return kLights + 2 * light;
}
inline constexpr std::uint64_t part(std::uint64_t light) {
  return kLights + 2 * light + 1;
}
static_assert(at(0, part(0xffff'fff0u)) < kBeam, "the lights of one bounce reach into the next");

}  // namespace etendue::dimension
