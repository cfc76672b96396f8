#include "geometry/curves.h"

#include "math/frame.h"

namespace etendue {
namespace {

/// Weights of four control points: a uniform cubic B-spline's basis functions, or their derivatives.
using Weights = float[4];

CurvePlace combine(const CurvePoint* p, const Weights& value, const Weights& first, const Weights& second) {
  CurvePlace out{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0, 0};
  for (int i = 0; i < 4; ++i) {
    out.center += p[i].position * value[i];
    out.velocity += p[i].position * first[i];
    out.acceleration += p[i].position * second[i];
    out.radius += p[i].radius * value[i];
    out.widening += p[i].radius * first[i];
  }
  return out;
}

CurvePlace place_on_bspline(const CurvePoint* p, float s) {
  const float r = 1 - s;
  return combine(p, {r * r * r / 6, (4 - 3 * s * s * (2 - s)) / 6, (4 - 3 * r * r * (2 - r)) / 6, s * s * s / 6},
                 {-r * r / 2, s * (3 * s - 4) / 2, -r * (3 * r - 4) / 2, s * s / 2}, {r, 3 * s - 2, 3 * r - 2, s});
}

/// Parameter s of the sphere that touches the envelope at `seen` = from + s·axis + r(s)·n, where n·axis = −widening.
float touching_sphere(const CurvePoint& from, const CurvePoint& to, const Point3& seen) {
  const Vec3 axis = to.position - from.position;
  const float widening = to.radius - from.radius;
  const float slant = length_squared(axis) - square(widening);
  if (!(slant > 0)) return widening > 0 ? 1.0f : 0.0f;  // one sphere holds the other
  const Vec3 offset = seen - from.position;
  return std::clamp((dot(offset, axis) + from.radius * widening) / slant, 0.0f, 1.0f);
}

/// Parameter of the disk across the curve in which `seen` lies, near `s`: one step of Newton's method on (seen − c)·c′
/// = 0.
float nearest_disk(const CurvePoint* p, float s, const Point3& seen) {
  const CurvePlace place = place_on_bspline(p, s);
  const Vec3 offset = seen - place.center;
  const float slope = length_squared(place.velocity) - dot(offset, place.acceleration);
  if (!(slope > 0.1f * length_squared(place.velocity))) return s;
  return std::clamp(s + dot(offset, place.velocity) / slope, 0.0f, 1.0f);
}

/// Directions across the curve from which and towards which u grows.
struct Around {
  Vec3 zero, quarter;
};

Around around(const Vec3& tangent) {
  const Vec3 guide(0, 0, 1);
  Vec3 quarter = guide - tangent * tangent.z;
  const float l2 = length_squared(quarter);
  quarter = l2 > 1e-12f ? quarter * (1 / std::sqrt(l2)) : Vec3(0, 1, 0);
  return {cross(quarter, tangent), quarter};
}

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const float l2 = length_squared(v);
  return l2 > 0 && std::isfinite(l2) ? v * (1 / std::sqrt(l2)) : otherwise;
}

}  // namespace

CurvePlace place_on(const CurvesShape& curves, std::uint32_t segment, float s) {
  const CurvePoint* p = &curves.points[curves.segments[segment]];
  if (curves.basis == CurvesShape::Basis::bspline) return place_on_bspline(p, s);
  const Vec3 axis = p[1].position - p[0].position;
  return {p[0].position + axis * s, axis, {0, 0, 0}, lerp(s, p[0].radius, p[1].radius), p[1].radius - p[0].radius};
}

CurveSurface surface_of(const CurvesShape& curves, std::uint32_t segment, float s, const Point3& seen) {
  const CurvePoint* p = &curves.points[curves.segments[segment]];
  const bool linear = curves.basis == CurvesShape::Basis::linear;
  CurveSurface out;
  out.s = linear ? touching_sphere(p[0], p[1], seen) : nearest_disk(p, s, seen);
  const CurvePlace place = place_on(curves, segment, out.s);
  const Vec3 spoke = unit_or(seen - place.center, around(unit_or(place.velocity, {1, 0, 0})).zero);
  out.position = place.center + spoke * place.radius;
  // The swept disks' surface leans by the widening, and more where the curve bends towards it.
  out.normal = linear
                   ? spoke
                   : unit_or(spoke * (length_squared(place.velocity) - place.radius * dot(spoke, place.acceleration)) -
                                 place.velocity * place.widening,
                             spoke);
  for (int i = 0; i < (linear ? 2 : 4); ++i)
    out.extent = std::max(out.extent, max_abs_component(p[i].position) + p[i].radius);
  return out;
}

CurveParametrization parametrization_of(const CurvesShape& curves, std::uint32_t segment, float s, const Vec3& normal) {
  const CurvePlace place = place_on(curves, segment, s);
  const float count = static_cast<float>(curves.segments.size());
  const Vec3 tangent = unit_or(place.velocity, {1, 0, 0});
  const Around axes = around(tangent);
  const Vec3 spoke = unit_or(normal - tangent * dot(normal, tangent), axes.zero);
  const float angle = std::atan2(dot(spoke, axes.quarter), dot(spoke, axes.zero));
  CurveParametrization out;
  out.uv = {angle < 0 ? 1 + angle * (0.5f * kInvPi) : angle * (0.5f * kInvPi),
            (static_cast<float>(segment) + s) / count};
  if (curves.basis == CurvesShape::Basis::linear) {
    out.dp_du = cross(tangent, normal) * (2 * kPi * place.radius);
    out.dp_dv = (place.velocity + normal * place.widening) * count;
    return out;
  }
  const Vec3 across = cross(tangent, spoke);
  const float speed = length(place.velocity);
  const Vec3 turning =
      (place.acceleration - tangent * dot(tangent, place.acceleration)) * (speed > 0 ? 1 / speed : 0.0f);
  // How fast the directions of `around` turn about the tangent as this changes.
  const float twist = dot(turning, axes.zero) * tangent.z / std::max(1e-6f, safe_sqrt(1 - square(tangent.z)));
  out.dp_du = across * (2 * kPi * place.radius);
  out.dp_dv =
      (place.velocity + spoke * place.widening + (across * twist - tangent * dot(spoke, turning)) * place.radius) *
      count;
  return out;
}

}  // namespace etendue
