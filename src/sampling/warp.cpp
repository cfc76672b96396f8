#include "sampling/warp.h"

namespace etendue {
namespace {

/// Sine and cosine of |x| ≤ π/4 by Taylor's series, to the last bit or two of a float.
struct SineCosine {
  float sine, cosine;
};
SineCosine of_small_angle(float x) {
  const float z = x * x;
  return {x * (1 + z * (-1.0f / 6 + z * (1.0f / 120 + z * (-1.0f / 5040 + z * (1.0f / 362880))))),
          1 + z * (-1.0f / 2 + z * (1.0f / 24 + z * (-1.0f / 720 + z * (1.0f / 40320))))};
}

}  // namespace

/// Shirley and Chiu 1997, without branches: which of the square's two pairs of wedges a point is in is as good as
/// random.
Vec2 sample_disk_concentric(Vec2 u) {
  const float x = 2 * u.x - 1, y = 2 * u.y - 1;
  const bool wide = std::abs(x) > std::abs(y);
  const float r = wide ? x : y, other = wide ? y : x;
  const SineCosine turn = of_small_angle((kPi / 4) * (r != 0 ? other / r : 0));
  const float along = r * turn.cosine, across = r * turn.sine;
  return {wide ? along : across, wide ? across : along};
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
