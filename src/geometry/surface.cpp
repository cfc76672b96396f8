#include <algorithm>

#include "geometry/geometry.h"

namespace etendue {
namespace {

/// Share of a position's coordinates that is lost on the way into an instance's space.
constexpr float kInstanceError = kRelativeError / 2;

/// The same as kRelativeError for B-splines, which Embree finds by iteration.
constexpr float kBsplineError = 8 * kRelativeError;

template <typename Vector>
Vector absolute(const Vector& v) {
  return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}

/// |m⁻¹| |m| |m⁻¹| for the linear part of m: Embree inverts in floats, which the condition of m makes worse.
Transform rounding_into(const Transform& m, const LocalSpace& local) {
  const Transform there{absolute(m.x), absolute(m.y), absolute(m.z), {0, 0, 0}};
  const Transform back{absolute(Vec3(local.vector({1, 0, 0}))),
                       absolute(Vec3(local.vector({0, 1, 0}))),
                       absolute(Vec3(local.vector({0, 0, 1}))),
                       {0, 0, 0}};
  return back * there * back;
}

float extent_of(const Transform& m) {
  return max_abs_component(m.origin) + max_abs_component(m.x) + max_abs_component(m.y) + max_abs_component(m.z);
}

SurfaceHit flat_hit(const ShapePoint& point, const Transform& to_world) {
  return {point.position, point.normal, point.normal, kRelativeError * extent_of(to_world)};
}

Parametrization parametrization_of(const SphereShape& s, const Vec3& outward) {
  const float turn = s.mirrored ? -1.0f : 1.0f;
  const Vec3 east = cross(s.pole, s.meridian) * turn;
  const float x = dot(outward, s.meridian), y = dot(outward, east), sine = std::sqrt(x * x + y * y);
  const float cosine = std::clamp(dot(outward, s.pole), -1.0f, 1.0f);
  const Vec3 level = sine > 0 ? (s.meridian * x + east * y) * (1 / sine) : s.meridian;
  Parametrization out;
  out.uv = {0.5f + 0.5f * kInvPi * std::atan2(y, x), 1 - std::acos(cosine) * kInvPi};
  out.dp_du = cross(s.pole, outward) * (turn * 2 * kPi * s.radius);
  out.dp_dv = (s.pole * sine - level * cosine) * (kPi * s.radius);
  return out;
}

/// Polar coordinates of the disk's local (x, y).
Parametrization parametrization_of(const DiskShape& disk, float x, float y) {
  const float radius = std::sqrt(x * x + y * y);
  const float c = radius > 0 ? x / radius : 1, s = radius > 0 ? y / radius : 0;
  const float turns = std::atan2(y, x) * (0.5f * kInvPi);
  Parametrization out;
  out.uv = {std::min(radius, 1.0f), turns < 0 ? turns + 1 : turns};
  out.dp_du = disk.to_world.vector({c, s, 0});
  out.dp_dv = disk.to_world.vector({-s, c, 0}) * (2 * kPi * radius);
  return out;
}

/// Vec3(0) in place of what has no direction.
Vec3 direction_of(const Vec3& v) {
  const float l2 = length_squared(v);
  return l2 > 0 && std::isfinite(l2) ? v * (1 / std::sqrt(l2)) : Vec3(0);
}

}  // namespace

Geometry::Instance::Instance(std::uint32_t of, std::uint32_t first, const Transform& place)
    : group(of), first_shape(first), to_world(place), local(place), rounding(rounding_into(place, local)) {}

bool can_place(const Transform& to_world) {
  constexpr double kLargest = 2.5e5;
  const LocalSpace local(to_world);
  const Vec3d sums =
      absolute(local.vector({1, 0, 0})) + absolute(local.vector({0, 1, 0})) + absolute(local.vector({0, 0, 1}));
  return is_finite(to_world.origin) && sums.x <= kLargest && sums.y <= kLargest && sums.z <= kLargest &&
         std::isfinite(to_world.determinant());
}

SurfaceHit Geometry::instanced_surface(const Ray& ray, const RayHit& hit) const {
  const Instance& instance = instances_[hit.instance];
  const Vec3d seen = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(hit.t);
  const SurfaceHit own = own_surface(hit, Point3(instance.local.point(seen)));
  const Transform& m = instance.to_world;
  SurfaceHit out;
  out.position = m.point(own.position);
  out.geometric_normal = instance.local.world_normal(own.geometric_normal);
  out.shading_normal = instance.local.world_normal(own.shading_normal);
  if (dot(out.shading_normal, out.geometric_normal) < 0) out.shading_normal = -out.shading_normal;
  // How wrong the local coordinates may be, and how far that shifts the surface along its normal.
  const Vec3 wrong =
      Vec3(own.error) + instance.rounding.vector(absolute(out.position) + absolute(m.origin)) * kInstanceError;
  const Vec3& n = out.geometric_normal;
  out.error = dot(wrong, absolute(Vec3(dot(m.x, n), dot(m.y, n), dot(m.z, n))));
  return out;
}

SurfaceHit Geometry::analytic_surface(const RayHit& hit, const Point3& seen) const {
  if (kind(hit.shape) == Kind::disk) return flat_hit(point_at(disk(hit.shape), hit.u, hit.v), disk(hit.shape).to_world);
  if (kind(hit.shape) == Kind::cylinder)
    return flat_hit(point_at(cylinder(hit.shape), hit.u, hit.v), cylinder(hit.shape).to_world);
  const CurvesShape& c = curves(hit.shape);
  const CurveSurface at = surface_of(c, hit.primitive, hit.u, seen);
  const float relative = c.basis == CurvesShape::Basis::bspline ? kBsplineError : kRelativeError;
  return {at.position, at.normal, at.normal, relative * at.extent};
}

Parametrization Geometry::parametrization(const RayHit& hit, const SurfaceHit& surface) const {
  if (hit.instance == kNone) return own_parametrization(hit, surface);
  const Instance& instance = instances_[hit.instance];
  const Transform& m = instance.to_world;
  // Normals go back by the transposed map.
  const auto own_normal = [&](const Vec3& n) { return direction_of({dot(m.x, n), dot(m.y, n), dot(m.z, n)}); };
  SurfaceHit own = surface;
  own.geometric_normal = own_normal(surface.geometric_normal);
  own.shading_normal = own_normal(surface.shading_normal);
  Parametrization out = own_parametrization(hit, own);
  out.dp_du = m.vector(out.dp_du);
  out.dp_dv = m.vector(out.dp_dv);
  return out;
}

/// In the shape's own space: only the normals of `surface` are looked at.
Parametrization Geometry::own_parametrization(const RayHit& hit, const SurfaceHit& surface) const {
  const Vec3& n = surface.geometric_normal;
  switch (kind(hit.shape)) {
    case Kind::mesh:
      return mesh_parametrization(hit, surface);
    case Kind::sphere:
      return parametrization_of(sphere(hit.shape), sphere(hit.shape).flip_normals ? -n : n);
    case Kind::disk:
      return parametrization_of(disk(hit.shape), hit.u, hit.v);
    case Kind::cylinder: {
      const ShapePoint at = point_at(cylinder(hit.shape), hit.u, hit.v);
      return {{hit.u, hit.v}, at.dp_da, at.dp_db};
    }
    case Kind::curves: {
      const CurveParametrization at = parametrization_of(curves(hit.shape), hit.primitive, hit.u, n);
      return {at.uv, at.dp_du, at.dp_dv};
    }
  }
  return {};
}

Parametrization Geometry::mesh_parametrization(const RayHit& hit, const SurfaceHit& surface) const {
  const TriangleMesh& m = mesh(hit.shape);
  const auto& [a, b, c] = m.triangles[hit.primitive];
  const Vec3 first = m.positions[b] - m.positions[a], second = m.positions[c] - m.positions[a];
  Parametrization out;
  out.uv = texture_coordinates(hit, surface);
  out.dp_du = first;
  out.dp_dv = second;
  if (m.uvs.empty()) return out;
  const Vec2 along_first = m.uvs[b] - m.uvs[a], along_second = m.uvs[c] - m.uvs[a];
  const float determinant = along_first.x * along_second.y - along_first.y * along_second.x;
  const float scale = 1 / determinant;
  out.dp_du = (first * along_second.y - second * along_first.y) * scale;
  out.dp_dv = (second * along_first.x - first * along_second.x) * scale;
  if (determinant == 0 || !is_finite(out.dp_du) || !is_finite(out.dp_dv)) {
    const Frame any = Frame::from_normal(surface.shading_normal);
    out.dp_du = any.s;
    out.dp_dv = any.t;
    return out;
  }
  return out;
}

std::uint32_t Geometry::attribute_id(std::string_view name) {
  const auto place = std::ranges::find(attribute_names_, name);
  const auto id = static_cast<std::uint32_t>(place - attribute_names_.begin());
  if (place == attribute_names_.end()) attribute_names_.emplace_back(name);
  return id;
}

const MeshAttribute* Geometry::find_attribute(std::uint32_t shape, std::uint32_t attribute) const {
  if (kind(shape) != Kind::mesh) return nullptr;
  const std::vector<std::uint32_t>& ids = mesh_attribute_ids_[shapes_[shape].index];
  const auto place = std::ranges::find(ids, attribute);
  return place == ids.end() ? nullptr : &mesh(shape).attributes[static_cast<std::size_t>(place - ids.begin())];
}

bool Geometry::has_attribute(std::uint32_t shape, std::uint32_t attribute) const {
  return find_attribute(shape, attribute) != nullptr;
}

std::optional<Spectrum> Geometry::attribute(const RayHit& hit, std::uint32_t attribute) const {
  const MeshAttribute* found = find_attribute(hit.shape, attribute);
  if (found == nullptr) return std::nullopt;
  const auto value = [found](std::uint32_t i) {
    const float* v = &found->values[static_cast<std::size_t>(i) * static_cast<std::size_t>(found->channels)];
    return found->channels == 1 ? Spectrum(v[0]) : Spectrum(v[0], v[1], v[2]);
  };
  if (found->per_face) return value(hit.primitive);
  const auto& [a, b, c] = mesh(hit.shape).triangles[hit.primitive];
  return value(a) * (1 - hit.u - hit.v) + value(b) * hit.u + value(c) * hit.v;
}

}  // namespace etendue
