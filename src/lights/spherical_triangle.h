#pragma once

#include "math/vec.h"

namespace etendue {

/// A triangle seen from a point, of which directions are drawn uniformly by solid angle (Arvo 1995, "Stratified
/// Sampling of Spherical Triangles"). In doubles: the differences it works with nearly cancel for slivers.
class SphericalTriangle {
 public:
  SphericalTriangle(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& from);
  float solid_angle() const { return static_cast<float>(solid_angle_); }  ///< 0 if it is seen edge-on
  Vec3 sample(Vec2 u) const;                                              ///< unit direction

 private:
  Vec3d a_, b_, c_;
  double alpha_ = 0, cos_c_ = 0, solid_angle_ = 0;
};

}  // namespace etendue
