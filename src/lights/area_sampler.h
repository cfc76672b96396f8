#pragma once

#include "geometry/geometry.h"
#include "sampling/distribution.h"

namespace etendue {

/// A point of a shape, as a ray would have found it.
struct AreaPoint {
  RayHit hit;
  SurfaceHit surface;
  float pdf_area = 0;  ///< density by area with which it was chosen; 0 where it was given
};

/// The point of a mesh's triangle with these weights of the second and third vertex.
AreaPoint mesh_point(const Geometry& geometry, std::uint32_t shape, std::uint32_t triangle, Vec2 weights);

/// A point of a disk, cylinder or sphere, from u uniform in [0,1)².
AreaPoint sample_curved(const Geometry& geometry, std::uint32_t shape, Vec2 u);

/// Points all over a shape that has an area: a mesh, disk, cylinder or sphere outside groups. The geometry has to
/// outlive it.
class AreaSampler {
 public:
  AreaSampler(const Geometry& geometry, std::uint32_t shape);

  /// From u and `choice`, uniform in [0,1): the place, and which triangle.
  AreaPoint sample(Vec2 u, float choice) const;
  float area() const { return area_; }

 private:
  const Geometry* geometry_;
  std::uint32_t shape_;
  DiscreteDistribution triangles_;  ///< by area; empty for shapes that are no meshes
  float area_ = 0;
};

}  // namespace etendue
