#pragma once

#include "math/vec.h"

namespace etendue {

/// A rectangle in space, prepared for sampling from points around it.
struct Rectangle {
  Point3 corner;
  Vec3 edge_x, edge_y;          ///< perpendicular; they span it from the corner
  Vec3 unit_x, unit_y, normal;  ///< unit; normal = unit_x × unit_y is the front
  float length_x = 0, length_y = 0;

  Rectangle() = default;
  Rectangle(const Point3& corner, const Vec3& edge_x, const Vec3& edge_y);
  float area() const { return length_x * length_y; }
  Point3 center() const { return corner + (edge_x + edge_y) * 0.5f; }
};

/// The rectangle seen from a point, as a spherical rectangle of which points are drawn uniformly by solid angle
/// (Ureña, Fajardo, King 2013, "An Area-Preserving Parametrization for Spherical Rectangles"). In doubles: the angles
/// are differences that nearly cancel, for long strips and grazing views.
class SphericalRectangle {
 public:
  SphericalRectangle(const Rectangle& rectangle, const Point3& from);
  float solid_angle() const { return static_cast<float>(solid_angle_); }
  Point3 sample(const Rectangle& rectangle, Vec2 u) const;

 private:
  double x0_, y0_, x1_, y1_, z0_;
  double b0_, b1_, k_, solid_angle_;
};

}  // namespace etendue
