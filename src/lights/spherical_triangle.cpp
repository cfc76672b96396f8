#include "lights/spherical_triangle.h"

namespace etendue {
namespace {

/// Angle between the planes with normals u and v.
double angle_between(const Vec3d& u, const Vec3d& v) {
  return std::atan2(u.cross(v).length(), u.dot(v));
}

double safe_root(double x) {
  return std::sqrt(std::max(x, 0.0));
}

}  // namespace

SphericalTriangle::SphericalTriangle(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& from)
    : a_((Vec3d(p0) - Vec3d(from)).normalized()),
      b_((Vec3d(p1) - Vec3d(from)).normalized()),
      c_((Vec3d(p2) - Vec3d(from)).normalized()) {
  // Van Oosterom and Strackee 1983: stable for the smallest triangles.
  const double volume = std::abs(a_.dot(b_.cross(c_)));
  const double solid = 2 * std::atan2(volume, 1 + a_.dot(b_) + b_.dot(c_) + c_.dot(a_));
  const Vec3d ab = a_.cross(b_), ac = a_.cross(c_);
  if (!(solid > 0) || ab.length2() == 0 || ac.length2() == 0) return;
  solid_angle_ = solid;
  alpha_ = angle_between(ab, ac);
  cos_c_ = a_.dot(b_);
}

Vec3 SphericalTriangle::sample(Vec2 u) const {
  // The sub-triangle with area u.x · Ω shares the vertices a, b and the angle α at a; its third vertex lies on the arc
  // from a to c.
  const double area = u.x * solid_angle_;
  const double sin_alpha = std::sin(alpha_), cos_alpha = std::cos(alpha_);
  const double phi = area - alpha_;
  const double s = std::sin(phi), t = std::cos(phi);
  const double p = t - cos_alpha, q = s + sin_alpha * cos_c_;
  const double numerator = (q * t - p * s) * cos_alpha - q;
  const double denominator = (q * s + p * t) * sin_alpha;
  const double cos_b = denominator != 0 ? std::clamp(numerator / denominator, -1.0, 1.0) : 1.0;
  const Vec3d toward_c = (c_ - a_ * c_.dot(a_)).normalized();
  const Vec3d c_new = a_ * cos_b + toward_c * safe_root(1 - cos_b * cos_b);
  const double z = 1 - u.y * (1 - c_new.dot(b_));
  const Vec3d across = (c_new - b_ * c_new.dot(b_)).normalized();
  return Vec3((b_ * z + across * safe_root(1 - z * z)).normalized());
}

}  // namespace etendue
