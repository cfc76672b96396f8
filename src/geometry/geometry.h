#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/analytic_shapes.h"
#include "geometry/curves.h"
#include "geometry/local_space.h"
#include "math/bounds.h"
#include "math/frame.h"
#include "math/ray.h"
#include "math/spectrum.h"

namespace etendue {

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// Bound of a surface point's rounding error, as a share of the largest coordinate that it was computed from:
/// barycentric interpolation of three vertices in floats is within γ₇ ≈ 7·2⁻²⁴ of exact (Higham 2002, section 3.1); the
/// ray that comes back rounds as much again, and Embree's t adds its own.
inline constexpr float kRelativeError = 32 * 0x1p-24f;

/// Values at a mesh's vertices or triangles.
struct MeshAttribute {
  std::string name;
  bool per_face = false;      ///< else one a vertex
  int channels = 3;           ///< 1 or 3
  std::vector<float> values;  ///< channel fastest
};

/// Triangles in world space, or in that of their group. The front of a triangle is the side from which its vertices run
/// counter-clockwise.
struct TriangleMesh {
  std::vector<Point3> positions;
  std::vector<Vec3> normals;  ///< empty: flat; else one a vertex, unit
  std::vector<Vec2> uvs;      ///< empty: none; else one a vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<MeshAttribute> attributes = {};
};

/// A sphere in world space, or in that of its group; its front is the outside.
struct SphereShape {
  Point3 center;
  float radius = 1;
  Vec3 pole{0, 1, 0};         ///< unit; where v = 1 of its texture coordinates
  Vec3 meridian{1, 0, 0};     ///< unit, perpendicular to the pole; where u = ½
  bool flip_normals = false;  ///< the front is the inside
  bool mirrored = false;      ///< longitude grows clockwise seen from the pole
};

/// What a ray meets first: enough to find out more, as small as possible.
struct RayHit {
  float t = 0;  ///< distance in units of the ray's direction
  /// Weights of a triangle's second and third vertex; a disk's or cylinder's point_at(); u: along a curve's segment.
  float u = 0, v = 0;
  std::uint32_t shape = kNone;     ///< index of the shape, in order of addition; kNone: nothing was hit
  std::uint32_t primitive = 0;     ///< triangle within the mesh, segment within the curves
  std::uint32_t instance = kNone;  ///< through which a group's shape was met; kNone: the shape is in no group

  bool found() const { return shape != kNone; }
};

/// A point on a surface.
struct SurfaceHit {
  Point3 position;
  Vec3 geometric_normal;  ///< unit, on the front
  Vec3 shading_normal;    ///< unit, in the same hemisphere as the geometric one
  float error = 0;        ///< bound of the position's rounding error: how far a ray must start off the surface
};

/// How texture coordinates run over a surface point.
struct Parametrization {
  Vec2 uv;
  Vec3 dp_du, dp_dv;  ///< world space, per unit of uv; any two tangents where a mesh's coordinates say nothing
};

/// Whether a group may be placed by this map: it is finite, invertible, and shrinks in no direction to less than about
/// 4·10⁻⁶, where rays that start 10¹² away would overflow in the group's space.
bool can_place(const Transform& to_world);

/// Sees every ray that a Geometry traces: for measuring what tracing alone costs. Called by the tracing thread.
class RayRecorder {
 public:
  virtual ~RayRecorder() = default;
  virtual void record(std::span<const Ray> rays, bool occlusion) = 0;
};

/// All shapes of a scene in one acceleration structure. Immutable after build; all queries are thread-safe.
class Geometry {
 public:
  /// How many rays the batch queries take at the most.
  static constexpr int kBatch = 16;

  Geometry();
  ~Geometry();
  Geometry(Geometry&&) noexcept;
  Geometry& operator=(Geometry&&) noexcept;

  /// All return the shape's index.
  std::uint32_t add(TriangleMesh mesh);
  std::uint32_t add(const SphereShape& sphere);
  std::uint32_t add(const DiskShape& disk);
  std::uint32_t add(const CylinderShape& cylinder);
  std::uint32_t add(CurvesShape curves);

  /// The shapes added until end_group() form a group: they are kept once and seen only through its instances. Returns
  /// the group's index. Groups do not nest: instances of a group inside another are instances of their own, their maps
  /// multiplied.
  std::uint32_t begin_group();
  void end_group();
  /// Places a finished group by a map that can_place() allows. Returns the instance's index.
  std::uint32_t add_instance(std::uint32_t group, const Transform& to_world);

  /// Builds the acceleration structure; once, after all shapes were added. Throws Error(Failure::input) when memory
  /// does not suffice.
  void build();

  RayHit intersect(const Ray& ray) const;
  /// The same for up to kBatch rays that start close to each other and run in similar directions.
  void intersect_coherent(std::span<const Ray> rays, std::span<RayHit> hits) const;
  /// For up to kBatch rays: bit i of the result is set when something lies on rays[i] between its t_min and t_max.
  std::uint32_t occluded(std::span<const Ray> rays) const;

  /// Position and normals where `ray` met something.
  SurfaceHit surface(const Ray& ray, const RayHit& hit) const;
  /// Texture coordinates there: the mesh's, or its barycentric weights if it has none; on a sphere longitude and
  /// latitude, v up; on a disk radius and angle / 2π, on a cylinder angle / 2π and height, on curves angle / 2π and the
  /// place along all segments.
  Vec2 texture_coordinates(const RayHit& hit, const SurfaceHit& surface) const;
  /// The same coordinates and how they run there. `surface` is what surface() gave for the hit.
  Parametrization parametrization(const RayHit& hit, const SurfaceHit& surface) const;

  /// Number of a mesh attribute's name, the same for all meshes of this geometry.
  std::uint32_t attribute_id(std::string_view name);
  bool has_attribute(std::uint32_t shape, std::uint32_t attribute) const;
  /// The attribute's value at a hit, grey if it has one channel; nullopt where the shape has no such attribute.
  std::optional<Spectrum> attribute(const RayHit& hit, std::uint32_t attribute) const;

  /// From now on `recorder` sees all rays; nullptr: none does. Not while rays are traced.
  void set_recorder(RayRecorder* recorder) { recorder_ = recorder; }

  enum class Kind : std::uint32_t { mesh, sphere, disk, cylinder, curves };
  Kind kind(std::uint32_t shape) const { return shapes_[shape].kind; }
  bool is_sphere(std::uint32_t shape) const { return kind(shape) == Kind::sphere; }
  const TriangleMesh& mesh(std::uint32_t shape) const { return meshes_[shapes_[shape].index]; }
  const SphereShape& sphere(std::uint32_t shape) const { return spheres_[shapes_[shape].index]; }
  const DiskShape& disk(std::uint32_t shape) const { return disks_[shapes_[shape].index]; }
  const CylinderShape& cylinder(std::uint32_t shape) const { return cylinders_[shapes_[shape].index]; }
  const CurvesShape& curves(std::uint32_t shape) const { return curves_[shapes_[shape].index]; }
  const Transform& instance_transform(std::uint32_t instance) const { return instances_[instance].to_world; }
  std::size_t shape_count() const { return shapes_.size(); }
  std::size_t triangle_count() const { return triangle_count_; }
  std::size_t sphere_count() const { return spheres_.size(); }
  std::size_t group_count() const { return groups_.size(); }
  std::size_t instance_count() const { return instances_.size(); }
  const Bounds3& bounds() const { return bounds_; }
  /// Of one shape, in the space of its group.
  const Bounds3& shape_bounds(std::uint32_t shape) const { return shape_bounds_[shape]; }

 private:
  struct Shape {
    Kind kind;
    std::uint32_t index;
  };
  struct Group {
    std::uint32_t first_shape, end_shape;
    Bounds3 bounds;
  };
  struct Instance {
    Instance(std::uint32_t group, std::uint32_t first_shape, const Transform& to_world);

    std::uint32_t group, first_shape;
    Transform to_world;
    LocalSpace local;
    Transform rounding;  ///< linear part: what an error of one unit in each world coordinate can become in local ones
  };
  struct Embree;

  std::uint32_t add_shape(Kind kind, std::size_t index, const Bounds3& bounds);
  Bounds3& open_bounds() { return group_is_open_ ? groups_.back().bounds : bounds_; }
  RayHit resolved(RayHit hit, std::uint32_t embree_instance) const;
  SurfaceHit instanced_surface(const Ray& ray, const RayHit& hit) const;
  SurfaceHit own_surface(const RayHit& hit, const Point3& seen) const;
  SurfaceHit analytic_surface(const RayHit& hit, const Point3& seen) const;
  Parametrization own_parametrization(const RayHit& hit, const SurfaceHit& surface) const;
  Parametrization mesh_parametrization(const RayHit& hit, const SurfaceHit& surface) const;
  const MeshAttribute* find_attribute(std::uint32_t shape, std::uint32_t attribute) const;

  std::vector<Shape> shapes_;
  std::vector<Bounds3> shape_bounds_;  ///< of each shape
  std::vector<TriangleMesh> meshes_;
  std::vector<SphereShape> spheres_;
  std::vector<DiskShape> disks_;
  std::vector<CylinderShape> cylinders_;
  std::vector<CurvesShape> curves_;
  std::vector<Group> groups_;
  std::vector<Instance> instances_;
  std::vector<std::string> attribute_names_;
  std::vector<std::vector<std::uint32_t>> mesh_attribute_ids_;  ///< of each mesh's attributes
  bool group_is_open_ = false;
  std::size_t triangle_count_ = 0;
  Bounds3 bounds_;
  std::unique_ptr<Embree> embree_;
  RayRecorder* recorder_ = nullptr;
};

/// Start of a ray that leaves `hit` into `direction`: off the surface, on the side that the direction points to, by
/// more than the rounding errors of the position and less than anything that is seen.
inline Point3 offset_origin(const SurfaceHit& hit, const Vec3& direction) {
  const float side = dot(hit.geometric_normal, direction) < 0 ? -hit.error : hit.error;
  return hit.position + hit.geometric_normal * side;
}

}  // namespace etendue
