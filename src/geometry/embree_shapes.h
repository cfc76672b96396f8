#pragma once

#include <embree3/rtcore.h>

#include "geometry/analytic_shapes.h"
#include "geometry/curves.h"
#include "geometry/local_space.h"

namespace etendue {

/// What Embree's callbacks need of a disk or cylinder. Must stay where it is as long as Embree knows of it.
struct EmbreeShape {
  template <typename Shape>
  explicit EmbreeShape(const Shape& shape) : bounds(bounds_of(shape)), local(shape.to_world) {}

  Bounds3 bounds;
  LocalSpace local;
};

/// Geometries, not committed, that refer to their last argument. The hits of disks and cylinders carry the parameters
/// of point_at() as u and v, those of curves the place along the segment as u. All but B-splines are intersected in
/// doubles: Embree's own round linear curves are wrong below a size of about 1 cm.
RTCGeometry make_embree_disk(RTCDevice device, const EmbreeShape& shape);
RTCGeometry make_embree_cylinder(RTCDevice device, const EmbreeShape& shape);
RTCGeometry make_embree_curves(RTCDevice device, const CurvesShape& curves);

}  // namespace etendue
