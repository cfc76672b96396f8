#include "lights/spherical_triangle.h"

namespace etendue {
namespace {

/// Angle between the planes with normals u and v.
float angle_between(const Vec3& u, const Vec3& v) { return std::atan2(length(cross(u, v)), dot(u, v)); }

}  // namespace

SphericalTriangle::SphericalTriangle(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& from)
    : a_(normalize(p0 - from)), b_(normalize(p1 - from)), c_(normalize(p2 - from)) {
  // Van Oosterom and Strackee 1983: stable for the smallest triangles.
  const float volume = std::abs(dot(a_, cross(b_, c_)));
  const float solid = 2 * std::atan2(volume, 1 + dot(a_, b_) + dot(b_, c_) + dot(c_, a_));
  const Vec3 ab = cross(a_, b_), ac = cross(a_, c_);
  if (!(solid > 0) || length_squared(ab) == 0 || length_squared(ac) == 0) return;
  solid_angle_ = solid;
  alpha_ = angle_between(ab, ac);
  cos_c_ = dot(a_, b_);
}

Vec3 SphericalTriangle::sample(Vec2 u) const {
  // The sub-triangle with area u.x · Ω shares the vertices a, b and the angle α at a; its third vertex lies on the arc from a to c.
  const float area = u.x * solid_angle_;
  const float sin_alpha = std::sin(alpha_), cos_alpha = std::cos(alpha_);
  const float phi = area - alpha_;
  const float s = std::sin(phi), t = std::cos(phi);
  const float p = t - cos_alpha, q = s + sin_alpha * cos_c_;
  const float numerator = (q * t - p * s) * cos_alpha - q;
  const float denominator = (q * s + p * t) * sin_alpha;
  const float cos_b = denominator != 0 ? std::clamp(numerator / denominator, -1.0f, 1.0f) : 1.0f;
  const Vec3 toward_c = normalize(c_ - a_ * dot(c_, a_));
  const Vec3 c_new = a_ * cos_b + toward_c * safe_sqrt(1 - square(cos_b));
  const float z = 1 - u.y * (1 - dot(c_new, b_));
  const Vec3 w = c_new - b_ * dot(c_new, b_);
  const float w2 = length_squared(w);
  if (w2 == 0) return b_;
  return normalize(b_ * z + w * (safe_sqrt(1 - square(z)) / std::sqrt(w2)));
}

}  // namespace etendue
