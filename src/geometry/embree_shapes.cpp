#include "geometry/embree_shapes.h"

#include <limits>
#include <optional>

namespace etendue {
namespace {

struct Query {
  Vec3d origin, direction;
  float t_min, t_max;

  bool reaches(double t) const { return t >= t_min && t <= t_max && t <= std::numeric_limits<float>::max(); }
};

struct Found {
  double t;
  Vec3d position;  ///< local for disks and cylinders
};

Query local(const Query& world, const LocalSpace& space) {
  return {space.point(world.origin), space.vector(world.direction), world.t_min, world.t_max};
}

struct Disk {
  using Data = EmbreeShape;

  static std::optional<Found> intersect(const EmbreeShape& shape, std::uint32_t, const Query& world) {
    const Query ray = local(world, shape.local);
    const double t = -ray.origin.z / ray.direction.z;
    if (!ray.reaches(t)) return std::nullopt;
    const Vec3d p = ray.origin + ray.direction * t;
    if (!(p.x * p.x + p.y * p.y <= 1)) return std::nullopt;
    return Found{t, p};
  }
  static Vec2 parameters(const EmbreeShape&, std::uint32_t, const Vec3d& p) {
    return {static_cast<float>(p.x), static_cast<float>(p.y)};
  }
  static Bounds3 bounds(const EmbreeShape& shape, std::uint32_t) { return shape.bounds; }
};

struct Cylinder {
  using Data = EmbreeShape;

  static std::optional<Found> intersect(const EmbreeShape& shape, std::uint32_t, const Query& world) {
    const Query ray = local(world, shape.local);
    const Vec3d &o = ray.origin, &d = ray.direction;
    const double a = d.x * d.x + d.y * d.y, b = o.x * d.x + o.y * d.y, c = o.x * o.x + o.y * o.y - 1;
    // b² − ac without its cancellation far from the axis: by Lagrange's identity, from the distance at which the ray
    // passes it.
    const double miss = o.x * d.y - o.y * d.x, discriminant = a - miss * miss;
    if (!(discriminant >= 0) || a == 0) return std::nullopt;
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    const double t0 = q / a, t1 = c / q;
    for (const double t : {std::min(t0, t1), std::max(t0, t1)}) {
      if (!ray.reaches(t)) continue;
      const Vec3d p = o + d * t;
      if (p.z >= 0 && p.z <= 1) return Found{t, p};
    }
    return std::nullopt;
  }
  static Vec2 parameters(const EmbreeShape&, std::uint32_t, const Vec3d& p) {
    const double turns = std::atan2(p.y, p.x) / (2 * std::numbers::pi);
    return {static_cast<float>(turns < 0 ? turns + 1 : turns), static_cast<float>(p.z)};
  }
  static Bounds3 bounds(const EmbreeShape& shape, std::uint32_t) { return shape.bounds; }
};

/// The hull of two spheres, of which a ray sees only where it enters (Han et al. 2019, "Ray Tracing Generalized Tube
/// Primitives").
struct LinearCurve {
  using Data = CurvesShape;

  static std::optional<Found> intersect(const CurvesShape& curves, std::uint32_t segment, const Query& ray) {
    const CurvePoint* p = &curves.points[curves.segments[segment]];
    const Vec3d &d = ray.direction, axis = Vec3d(p[1].position) - Vec3d(p[0].position);
    const double d2 = d.dot(d), r0 = p[0].radius, widening = static_cast<double>(p[1].radius) - r0;
    // Relative to p[0], and from where the ray comes nearest to it: far origins cost no digits.
    const Vec3d start = ray.origin - Vec3d(p[0].position);
    const double shift = -start.dot(d) / d2;
    const Vec3d o = start + d * shift;
    double nearest = std::numeric_limits<double>::infinity();
    const auto enter_sphere = [&](const Vec3d& center, double radius) {
      const Vec3d c = o - center;
      const double b = c.dot(d), nearness = radius * radius - (c - d * (b / d2)).length2();
      if (nearness >= 0) nearest = std::min(nearest, (-b - std::sqrt(d2 * nearness)) / d2);
    };
    enter_sphere(Vec3d(0), r0);
    enter_sphere(axis, p[1].radius);
    // Between the circles where it touches the spheres, the envelope is |x|²·slant = (x·axis)² + 2·r0·widening·(x·axis)
    // + r0²·axis².
    const double slant = axis.length2() - widening * widening;
    if (slant > 0) {
      const double along = d.dot(axis), height = o.dot(axis) + r0 * widening;
      const double a = slant * d2 - along * along, b = slant * o.dot(d) - along * height;
      const double c = slant * (o.length2() - r0 * r0) - height * height;
      const double discriminant = b * b - a * c;
      if (discriminant >= 0 && a != 0) {
        const double t = (-b - std::sqrt(discriminant)) / a, h = height + t * along;
        if (h >= 0 && h <= slant) nearest = std::min(nearest, t);
      }
    }
    if (!ray.reaches(nearest + shift)) return std::nullopt;
    return Found{nearest + shift, ray.origin + d * (nearest + shift)};
  }
  static Vec2 parameters(const CurvesShape& curves, std::uint32_t segment, const Vec3d& p) {
    return {surface_of(curves, segment, 0, Point3(p)).s, 0};
  }
  static Bounds3 bounds(const CurvesShape& curves, std::uint32_t segment) {
    Bounds3 box;
    for (std::uint32_t i = 0; i < 2; ++i) {
      const CurvePoint& point = curves.points[curves.segments[segment] + i];
      box.extend(point.position - Vec3(point.radius));
      box.extend(point.position + Vec3(point.radius));
    }
    return box;
  }
};

template <typename Shape>
void bound(const RTCBoundsFunctionArguments* args) {
  const Bounds3 box = Shape::bounds(*static_cast<const typename Shape::Data*>(args->geometryUserPtr), args->primID);
  // More than what the box and the surface's points are rounded by.
  const Vec3 margin(8 * std::numeric_limits<float>::epsilon() *
                    std::max(max_abs_component(box.min), max_abs_component(box.max)));
  const Point3 low = box.min - margin, high = box.max + margin;
  *args->bounds_o = {low.x, low.y, low.z, 0, high.x, high.y, high.z, 0};
}

Query query(RTCRayN* rays, unsigned n, unsigned i) {
  return {{RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i)},
          {RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i)},
          RTCRayN_tnear(rays, n, i),
          RTCRayN_tfar(rays, n, i)};
}

template <typename Shape>
void intersect(const RTCIntersectFunctionNArguments* args) {
  const auto& data = *static_cast<const typename Shape::Data*>(args->geometryUserPtr);
  const unsigned n = args->N;
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, n);
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] == 0) continue;
    const std::optional<Found> found = Shape::intersect(data, args->primID, query(rays, n, i));
    if (!found) continue;
    const Vec2 parameters = Shape::parameters(data, args->primID, found->position);
    RTCRayN_tfar(rays, n, i) = static_cast<float>(found->t);
    RTCHitN_u(hits, n, i) = parameters.x;
    RTCHitN_v(hits, n, i) = parameters.y;
    RTCHitN_primID(hits, n, i) = args->primID;
    RTCHitN_geomID(hits, n, i) = args->geomID;
    RTCHitN_instID(hits, n, i, 0) = args->context->instID[0];
  }
}

template <typename Shape>
void occlude(const RTCOccludedFunctionNArguments* args) {
  const auto& data = *static_cast<const typename Shape::Data*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i)
    if (args->valid[i] != 0 && Shape::intersect(data, args->primID, query(args->ray, args->N, i)))
      RTCRayN_tfar(args->ray, args->N, i) = -std::numeric_limits<float>::infinity();
}

template <typename Shape>
RTCGeometry make(RTCDevice device, const typename Shape::Data& data, std::size_t count) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
  rtcSetGeometryUserData(geometry, const_cast<typename Shape::Data*>(&data));  // only read by the callbacks
  rtcSetGeometryBoundsFunction(geometry, bound<Shape>, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect<Shape>);
  rtcSetGeometryOccludedFunction(geometry, occlude<Shape>);
  return geometry;
}

/// Rejects what a ray meets from inside.
void see_front_only(const RTCFilterFunctionNArguments* args) {
  const unsigned n = args->N;
  for (unsigned i = 0; i < n; ++i) {
    const float cosine = RTCRayN_dir_x(args->ray, n, i) * RTCHitN_Ng_x(args->hit, n, i) +
                         RTCRayN_dir_y(args->ray, n, i) * RTCHitN_Ng_y(args->hit, n, i) +
                         RTCRayN_dir_z(args->ray, n, i) * RTCHitN_Ng_z(args->hit, n, i);
    if (cosine > 0) args->valid[i] = 0;
  }
}

RTCGeometry make_bspline(RTCDevice device, const CurvesShape& c) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, c.points.data(), 0,
                             sizeof(CurvePoint), c.points.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, c.segments.data(), 0,
                             sizeof(std::uint32_t), c.segments.size());
  rtcSetGeometryIntersectFilterFunction(geometry, see_front_only);
  rtcSetGeometryOccludedFilterFunction(geometry, see_front_only);
  return geometry;
}

}  // namespace

RTCGeometry make_embree_disk(RTCDevice device, const EmbreeShape& shape) {
  return make<Disk>(device, shape, 1);
}
RTCGeometry make_embree_cylinder(RTCDevice device, const EmbreeShape& shape) {
  return make<Cylinder>(device, shape, 1);
}

RTCGeometry make_embree_curves(RTCDevice device, const CurvesShape& curves) {
  if (curves.basis == CurvesShape::Basis::bspline) return make_bspline(device, curves);
  return make<LinearCurve>(device, curves, curves.segments.size());
}

}  // namespace etendue
