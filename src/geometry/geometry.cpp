#include "geometry/geometry.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include "base/error.h"

namespace etendue {
namespace {

RTCDevice make_device() {
  RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr) throw Error(Failure::internal, "the ray tracing kernels (Embree) could not be started on this machine");
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
  std::vector<std::array<float, 4>> sphere_vertices;

  Embree() = default;
  ~Embree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void attach(RTCGeometry geometry, unsigned id) {
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }
};

Geometry::Geometry() : embree_(std::make_unique<Embree>()) {}
Geometry::~Geometry() = default;
Geometry::Geometry(Geometry&&) noexcept = default;
Geometry& Geometry::operator=(Geometry&&) noexcept = default;

std::uint32_t Geometry::add(TriangleMesh mesh) {
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) bounds_.extend(mesh.positions[vertex]);
  triangle_count_ += mesh.triangles.size();
  // Embree reads 16 bytes at each vertex, so the last one needs room behind it.
  mesh.positions.reserve(mesh.positions.size() + 2);
  meshes_.push_back(std::move(mesh));
  shapes_.push_back({false, static_cast<std::uint32_t>(meshes_.size() - 1)});
  return static_cast<std::uint32_t>(shapes_.size() - 1);
}

std::uint32_t Geometry::add(const SphereShape& sphere) {
  bounds_.extend(sphere.center - Vec3(sphere.radius));
  bounds_.extend(sphere.center + Vec3(sphere.radius));
  spheres_.push_back(sphere);
  shapes_.push_back({true, static_cast<std::uint32_t>(spheres_.size() - 1)});
  return static_cast<std::uint32_t>(shapes_.size() - 1);
}

void Geometry::build() {
  Embree& e = *embree_;
  rtcSetSceneFlags(e.scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(e.scene, RTC_BUILD_QUALITY_MEDIUM);
  e.sphere_vertices.reserve(spheres_.size() + 1);
  for (std::uint32_t id = 0; id < shapes_.size(); ++id) {
    if (shapes_[id].is_sphere) {
      const SphereShape& s = sphere(id);
      e.sphere_vertices.push_back({s.center.x, s.center.y, s.center.z, s.radius});
      RTCGeometry g = rtcNewGeometry(e.device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
      rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, &e.sphere_vertices.back(), 0,
                                 sizeof(std::array<float, 4>), 1);
      e.attach(g, id);
    } else {
      const TriangleMesh& m = mesh(id);
      RTCGeometry g = rtcNewGeometry(e.device, RTC_GEOMETRY_TYPE_TRIANGLE);
      rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, m.positions.data(), 0, sizeof(Point3),
                                 m.positions.size());
      rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, m.triangles.data(), 0,
                                 3 * sizeof(std::uint32_t), m.triangles.size());
      e.attach(g, id);
    }
  }
  rtcCommitScene(e.scene);
  if (const RTCError error = rtcGetDeviceError(e.device); error != RTC_ERROR_NONE)
    throw Error(Failure::input, fmt::format("the acceleration structure for {} triangles could not be built: {}",
                                            triangle_count_,
                                            error == RTC_ERROR_OUT_OF_MEMORY ? "memory does not suffice" : "Embree refused"));
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
  return {query.ray.tfar, query.hit.u, query.hit.v, query.hit.geomID, query.hit.primID};
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
    hits[i] = {query.ray.tfar[i], query.hit.u[i], query.hit.v[i], query.hit.geomID[i], query.hit.primID[i]};
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
  SurfaceHit out;
  if (shapes_[hit.shape].is_sphere) {
    const SphereShape& s = sphere(hit.shape);
    out.geometric_normal = normalize(ray.at(hit.t) - s.center);
    out.shading_normal = out.geometric_normal;
    out.position = s.center + out.geometric_normal * s.radius;
    out.error = kRelativeError * (max_abs_component(out.position) + s.radius);
    return out;
  }
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
  if (shapes_[hit.shape].is_sphere) {
    const Vec3& n = surface.geometric_normal;
    const Vec3 &pole = sphere(hit.shape).pole, &meridian = sphere(hit.shape).meridian;
    const float longitude = std::atan2(dot(n, cross(pole, meridian)), dot(n, meridian));
    const float colatitude = std::acos(std::clamp(dot(n, pole), -1.0f, 1.0f));
    return {0.5f + 0.5f * kInvPi * longitude, 1 - colatitude * kInvPi};
  }
  const TriangleMesh& m = mesh(hit.shape);
  if (m.uvs.empty()) return {hit.u, hit.v};
  const auto& [a, b, c] = m.triangles[hit.primitive];
  return m.uvs[a] * (1 - hit.u - hit.v) + m.uvs[b] * hit.u + m.uvs[c] * hit.v;
}

}  // namespace etendue
