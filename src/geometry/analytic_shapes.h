#pragma once

#include "math/bounds.h"
#include "math/transform.h"

namespace etendue {

/// The unit disk in the local xy plane under an invertible map. Its front is the local +z side, also if the map
/// mirrors.
struct DiskShape {
  Transform to_world;
  bool flip_normals = false;  ///< the front is the other side
};

/// The open cylinder x² + y² = 1, 0 ≤ z ≤ 1 under an invertible map. Its front is the outside, also if the map mirrors.
struct CylinderShape {
  Transform to_world;
  bool flip_normals = false;  ///< the front is the inside
};

/// A point on a shape that is known by its two parameters.
struct ShapePoint {
  Point3 position;
  Vec3 normal;        ///< unit, on the front
  Vec3 dp_da, dp_db;  ///< derivatives by the parameters; the area element is the length of their cross product
};

/// `a`, `b`: the local x and y.
ShapePoint point_at(const DiskShape& disk, float a, float b);
/// `a`: the angle from the local x axis towards y, in turns. `b`: the local z.
ShapePoint point_at(const CylinderShape& cylinder, float a, float b);

Bounds3 bounds_of(const DiskShape& disk);
Bounds3 bounds_of(const CylinderShape& cylinder);
float area_of(const DiskShape& disk);
float area_of(const CylinderShape& cylinder);

}  // namespace etendue
