#include "sampling/warp.h"

namespace etendue {

Vec2 sample_disk_concentric(Vec2 u) {
  const float x = 2 * u.x - 1, y = 2 * u.y - 1;
  if (x == 0 && y == 0) return {0, 0};
  const bool wide = std::abs(x) > std::abs(y);
  const float r = wide ? x : y;
  const float phi = wide ? (kPi / 4) * (y / x) : kPi / 2 - (kPi / 4) * (x / y);
  return {r * std::cos(phi), r * std::sin(phi)};
}

Vec3 sample_hemisphere_cosine(Vec2 u) {
  const Vec2 d = sample_disk_concentric(u);
  return {d.x, d.y, safe_sqrt(1 - d.x * d.x - d.y * d.y)};
}

Vec3 sample_hemisphere_uniform(Vec2 u) {
  const float z = u.x, r = safe_sqrt(1 - z * z), phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

Vec3 sample_sphere_uniform(Vec2 u) {
  const float z = 1 - 2 * u.x, r = safe_sqrt(1 - z * z), phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

Vec3 sample_cone_uniform(Vec2 u, float one_minus_cos) {
  const float h = u.x * one_minus_cos;     // 1 − cos θ
  const float r = safe_sqrt(h * (2 - h));  // sin θ, without cancellation
  const float phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), 1 - h};
}

Vec2 sample_triangle_uniform(Vec2 u) {
  return u.x < u.y ? Vec2(u.x * 0.5f, u.y - u.x * 0.5f) : Vec2(u.x - u.y * 0.5f, u.y * 0.5f);
}

}  // namespace etendue
