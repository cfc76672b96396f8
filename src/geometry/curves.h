#pragma once

#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace etendue {

/// A control point of a curve. Laid out as Embree reads it.
struct CurvePoint {
  Point3 position;
  float radius = 0;
};

/// Round curves, seen from outside only: what a ray meets from inside is not there. Linear ones are spheres swept along
/// their segments, with round ends; B-splines are disks swept across their curves, with open ends.
struct CurvesShape {
  enum class Basis { linear, bspline };  ///< bspline: uniform and cubic
  Basis basis = Basis::bspline;
  std::vector<CurvePoint> points;  ///< of all curves, one after the other
  /// Index of each segment's first point; it uses 2 (linear) or 4 (bspline) in a row.
  std::vector<std::uint32_t> segments;
};

/// A place along a segment.
struct CurvePlace {
  Vec3 center;                     ///< of the swept sphere
  Vec3 velocity, acceleration;     ///< derivatives of the centre by the segment's parameter
  float radius = 0, widening = 0;  ///< `widening`: derivative of the radius
};

/// `s` in [0, 1] from the segment's beginning to its end.
CurvePlace place_on(const CurvesShape& curves, std::uint32_t segment, float s);

/// Where on the surface of a curve a ray ended, up to rounding.
struct CurveSurface {
  Point3 position;
  Vec3 normal;       ///< unit, outward
  float s = 0;       ///< along the segment
  float extent = 0;  ///< largest coordinate that went into the position
};

/// `seen`: a point close to the surface of the segment. `s`: roughly where along the segment.
CurveSurface surface_of(const CurvesShape& curves, std::uint32_t segment, float s, const Point3& seen);

/// Texture coordinates and their directions: u runs around the curve, counter-clockwise seen from its end, v along all
/// segments from 0 to 1.
struct CurveParametrization {
  Vec2 uv;
  Vec3 dp_du, dp_dv;
};

/// At a point of a segment's surface with this outward normal.
CurveParametrization parametrization_of(const CurvesShape& curves, std::uint32_t segment, float s, const Vec3& normal);

}  // namespace etendue
