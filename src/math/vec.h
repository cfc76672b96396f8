#pragma once

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace etendue {

using Vec2 = Imath::V2f;
using Vec3 = Imath::V3f;
using Point3 = Vec3;       ///< a position; Vec3 is a direction or a difference
using Vec3d = Imath::V3d;  ///< where floats would cancel

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;
inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;  ///< the largest float below 1

inline float dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length_squared(const Vec3& v) {
  return dot(v, v);
}
inline float length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}
/// v / |v|; not finite for the zero vector.
inline Vec3 normalize(const Vec3& v) {
  return v * (1.0f / std::sqrt(dot(v, v)));
}
inline float max_abs_component(const Vec3& v) {
  return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
}
inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline float radians(float degrees) {
  return degrees * (kPi / 180.0f);
}
inline float degrees(float radians) {
  return radians * (180.0f / kPi);
}
inline float square(float x) {
  return x * x;
}
/// sqrt that treats small negative rounding errors as zero.
inline float safe_sqrt(float x) {
  return std::sqrt(std::max(x, 0.0f));
}
inline float lerp(float t, float a, float b) {
  return a + t * (b - a);
}

}  // namespace etendue
