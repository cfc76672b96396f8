#include "geometry/geometry.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include "base/error.h"
#include "geometry/embree_shapes.h"

namespace etendue {
namespace {

RTCDevice make_device() {
  RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr)
    throw Error(Failure::internal, "the ray tracing kernels (Embree) could not be started on this machine");
  return device;
}

void set_ray(RTCRay& to, const Ray& from) {
  to.org_x = from.origin.x;
  to.org_y = from.origin.y;
  to.org_z = from.origin.z;
  to.tnear = from.t_min;
  to.dir_x = from.direction.x;
  to.dir_y = from.direction.y;
  to.dir_z = from.direction.z;
  to.tfar = from.t_max;
  to.time = 0;
  to.mask = 0xffffffffu;
  to.id = 0;
  to.flags = 0;
}

template <typename RayPacket>
void set_ray(RayPacket& to, int i, const Ray& from) {
  to.org_x[i] = from.origin.x;
  to.org_y[i] = from.origin.y;
  to.org_z[i] = from.origin.z;
  to.tnear[i] = from.t_min;
  to.dir_x[i] = from.direction.x;
  to.dir_y[i] = from.direction.y;
  to.dir_z[i] = from.direction.z;
  to.tfar[i] = from.t_max;
  to.time[i] = 0;
  to.mask[i] = 0xffffffffu;
  to.id[i] = 0;
  to.flags[i] = 0;
}

}  // namespace

struct Geometry::Embree {
  RTCDevice device = make_device();
  RTCScene scene = rtcNewScene(device);
  std::vector<RTCScene> group_scenes;
  std::vector<std::array<float, 4>> sphere_vertices;
  std::vector<EmbreeShape> analytic_shapes;

  Embree() = default;
  ~Embree() {
    for (const RTCScene group : group_scenes) rtcReleaseScene(group);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  static void attach(RTCScene to, RTCGeometry geometry, unsigned id) {
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(to, geometry, id);
    rtcReleaseGeometry(geometry);
  }
  static void commit(RTCScene of) {
    rtcSetSceneFlags(of, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(of, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitScene(of);
  }
  RTCGeometry make(const TriangleMesh& mesh);
  RTCGeometry make(const SphereShape& sphere);
  RTCGeometry make_instance(RTCScene group, const Transform& to_world);
};

Geometry::Geometry() : embree_(std::make_unique<Embree>()) {}
Geometry::~Geometry() = default;
Geometry::Geometry(Geometry&&) noexcept = default;
Geometry& Geometry::operator=(Geometry&&) noexcept = default;

RTCGeometry Geometry::Embree::make(const TriangleMesh& m) {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, m.positions.data(), 0, sizeof(Point3),
                             m.positions.size());
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, m.triangles.data(), 0,
                             3 * sizeof(std::uint32_t), m.triangles.size());
  return g;
}

RTCGeometry Geometry::Embree::make(const SphereShape& s) {
  sphere_vertices.push_back({s.center.x, s.center.y, s.center.z, s.radius});
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, &sphere_vertices.back(), 0,
                             sizeof(std::array<float, 4>), 1);
  return g;
}

RTCGeometry Geometry::Embree::make_instance(RTCScene group, const Transform& to_world) {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(g, group);
  rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &to_world);
  return g;
}

std::uint32_t Geometry::add_shape(Kind kind, std::size_t index, const Bounds3& bounds) {
  open_bounds().extend(bounds);
  shape_bounds_.push_back(bounds);
  shapes_.push_back({kind, static_cast<std::uint32_t>(index)});
  return static_cast<std::uint32_t>(shapes_.size() - 1);
}

std::uint32_t Geometry::add(TriangleMesh mesh) {
  Bounds3 bounds;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) bounds.extend(mesh.positions[vertex]);
  triangle_count_ += mesh.triangles.size();
  // Embree reads 16 bytes at each vertex, so the last one needs room behind it.
  mesh.positions.reserve(mesh.positions.size() + 2);
  std::vector<std::uint32_t>& attribute_ids = mesh_attribute_ids_.emplace_back();
  for (const MeshAttribute& attribute : mesh.attributes) attribute_ids.push_back(attribute_id(attribute.name));
  meshes_.push_back(std::move(mesh));
  return add_shape(Kind::mesh, meshes_.size() - 1, bounds);
}

std::uint32_t Geometry::add(const SphereShape& sphere) {
  spheres_.push_back(sphere);
  return add_shape(Kind::sphere, spheres_.size() - 1,
                   {sphere.center - Vec3(sphere.radius), sphere.center + Vec3(sphere.radius)});
}

std::uint32_t Geometry::add(const DiskShape& disk) {
  disks_.push_back(disk);
  return add_shape(Kind::disk, disks_.size() - 1, bounds_of(disk));
}

std::uint32_t Geometry::add(const CylinderShape& cylinder) {
  cylinders_.push_back(cylinder);
  return add_shape(Kind::cylinder, cylinders_.size() - 1, bounds_of(cylinder));
}

std::uint32_t Geometry::add(CurvesShape curves) {
  Bounds3 bounds;
  const std::uint32_t used = curves.basis == CurvesShape::Basis::linear ? 2 : 4;
  for (const std::uint32_t first : curves.segments)
    for (std::uint32_t i = first; i < first + used; ++i) {
      bounds.extend(curves.points[i].position - Vec3(curves.points[i].radius));
      bounds.extend(curves.points[i].position + Vec3(curves.points[i].radius));
    }
  curves_.push_back(std::move(curves));
  return add_shape(Kind::curves, curves_.size() - 1, bounds);
}

std::uint32_t Geometry::begin_group() {
  const auto first = static_cast<std::uint32_t>(shapes_.size());
  groups_.push_back({first, first, {}});
  group_is_open_ = true;
  return static_cast<std::uint32_t>(groups_.size() - 1);
}

void Geometry::end_group() {
  groups_.back().end_shape = static_cast<std::uint32_t>(shapes_.size());
  group_is_open_ = false;
}

std::uint32_t Geometry::add_instance(std::uint32_t group, const Transform& to_world) {
  instances_.emplace_back(group, groups_[group].first_shape, to_world);
  const Bounds3& own = groups_[group].bounds;
  for (int corner = 0; corner < (own.empty() ? 0 : 8); ++corner)
    bounds_.extend(to_world.point(
        {corner & 1 ? own.max.x : own.min.x, corner & 2 ? own.max.y : own.min.y, corner & 4 ? own.max.z : own.min.z}));
  return static_cast<std::uint32_t>(instances_.size() - 1);
}

void Geometry::build() {
  Embree& e = *embree_;
  e.sphere_vertices.reserve(spheres_.size());
  e.analytic_shapes.reserve(disks_.size() + cylinders_.size());
  const auto make = [&](std::uint32_t shape) {
    switch (kind(shape)) {
      case Kind::mesh:
        return e.make(mesh(shape));
      case Kind::sphere:
        return e.make(sphere(shape));
      case Kind::disk:
        return make_embree_disk(e.device, e.analytic_shapes.emplace_back(disk(shape)));
      case Kind::cylinder:
        return make_embree_cylinder(e.device, e.analytic_shapes.emplace_back(cylinder(shape)));
      default:
        return make_embree_curves(e.device, curves(shape));
    }
  };
  std::uint32_t shape = 0;
  for (const Group& group : groups_) {
    for (; shape < group.first_shape; ++shape) e.attach(e.scene, make(shape), shape);
    const RTCScene scene = e.group_scenes.emplace_back(rtcNewScene(e.device));
    for (; shape < group.end_shape; ++shape) e.attach(scene, make(shape), shape - group.first_shape);
    e.commit(scene);
  }
  for (; shape < shapes_.size(); ++shape) e.attach(e.scene, make(shape), shape);
  for (const Instance& instance : instances_)
    e.attach(e.scene, e.make_instance(e.group_scenes[instance.group], instance.to_world), shape++);
  e.commit(e.scene);
  if (const RTCError error = rtcGetDeviceError(e.device); error != RTC_ERROR_NONE)
    throw Error(Failure::input,
                fmt::format("the acceleration structure for {} triangles could not be built: {}", triangle_count_,
                            error == RTC_ERROR_OUT_OF_MEMORY ? "memory does not suffice" : "Embree refused"));
}

RayHit Geometry::resolved(RayHit hit, std::uint32_t embree_instance) const {
  if (embree_instance == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.instance = embree_instance - static_cast<std::uint32_t>(shapes_.size());
  hit.shape += instances_[hit.instance].first_shape;
  return hit;
}

RayHit Geometry::intersect(const Ray& ray) const {
  if (recorder_ != nullptr) recorder_->record(std::span(&ray, 1), false);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query;
  set_ray(query.ray, ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->scene, &context, &query);
  return resolved({query.ray.tfar, query.hit.u, query.hit.v, query.hit.geomID, query.hit.primID}, query.hit.instID[0]);
}

void Geometry::intersect_coherent(std::span<const Ray> rays, std::span<RayHit> hits) const {
  if (recorder_ != nullptr) recorder_->record(rays, false);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(64) int valid[kBatch];
  RTCRayHit16 query;
  const int count = static_cast<int>(rays.size());
  for (int i = 0; i < kBatch; ++i) {
    valid[i] = i < count ? -1 : 0;
    set_ray(query.ray, i, rays[i < count ? i : 0]);
    query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  rtcIntersect16(valid, embree_->scene, &context, &query);
  for (int i = 0; i < count; ++i)
    hits[i] = resolved({query.ray.tfar[i], query.hit.u[i], query.hit.v[i], query.hit.geomID[i], query.hit.primID[i]},
                       query.hit.instID[0][i]);
}

std::uint32_t Geometry::occluded(std::span<const Ray> rays) const {
  if (recorder_ != nullptr) recorder_->record(rays, true);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const int count = static_cast<int>(rays.size());
  if (count == 1) {
    RTCRay query;
    set_ray(query, rays[0]);
    rtcOccluded1(embree_->scene, &context, &query);
    return query.tfar < 0 ? 1u : 0u;
  }
  alignas(64) int valid[kBatch];
  RTCRay16 query;
  for (int i = 0; i < kBatch; ++i) {
    valid[i] = i < count ? -1 : 0;
    set_ray(query, i, rays[i < count ? i : 0]);
  }
  rtcOccluded16(valid, embree_->scene, &context, &query);
  std::uint32_t mask = 0;
  for (int i = 0; i < count; ++i) mask |= (query.tfar[i] < 0 ? 1u : 0u) << i;
  return mask;
}

SurfaceHit Geometry::surface(const Ray& ray, const RayHit& hit) const {
  if (hit.instance != kNone) return instanced_surface(ray, hit);
  return own_surface(hit, ray.at(hit.t));
}

SurfaceHit Geometry::own_surface(const RayHit& hit, const Point3& seen) const {
  SurfaceHit out;
  if (is_sphere(hit.shape)) {
    const SphereShape& s = sphere(hit.shape);
    out.geometric_normal = normalize(seen - s.center);
    out.position = s.center + out.geometric_normal * s.radius;
    if (s.flip_normals) out.geometric_normal = -out.geometric_normal;
    out.shading_normal = out.geometric_normal;
    out.error = kRelativeError * (max_abs_component(out.position) + s.radius);
    return out;
  }
  if (kind(hit.shape) != Kind::mesh) return analytic_surface(hit, seen);
  const TriangleMesh& m = mesh(hit.shape);
  const auto& [a, b, c] = m.triangles[hit.primitive];
  const Point3 &p0 = m.positions[a], &p1 = m.positions[b], &p2 = m.positions[c];
  const float w = 1 - hit.u - hit.v;
  out.position = p0 * w + p1 * hit.u + p2 * hit.v;
  out.geometric_normal = normalize(cross(p1 - p0, p2 - p0));
  // Not the position's own size: near the origin the vertices' rounding, and that of the triangle in Embree, remains.
  out.error = kRelativeError * std::max({max_abs_component(p0), max_abs_component(p1), max_abs_component(p2)});
  out.shading_normal = out.geometric_normal;
  if (!m.normals.empty()) {
    const Vec3 n = m.normals[a] * w + m.normals[b] * hit.u + m.normals[c] * hit.v;
    const float l2 = length_squared(n);
    if (l2 > 1e-12f) out.shading_normal = n * (1 / std::sqrt(l2));
    if (dot(out.shading_normal, out.geometric_normal) < 0) out.shading_normal = -out.shading_normal;
  }
  return out;
}

Vec2 Geometry::texture_coordinates(const RayHit& hit, const SurfaceHit& surface) const {
  if (kind(hit.shape) != Kind::mesh) return parametrization(hit, surface).uv;
  const TriangleMesh& m = mesh(hit.shape);
  if (m.uvs.empty()) return {hit.u, hit.v};
  const auto& [a, b, c] = m.triangles[hit.primitive];
  return m.uvs[a] * (1 - hit.u - hit.v) + m.uvs[b] * hit.u + m.uvs[c] * hit.v;
}

}  // namespace etendue
