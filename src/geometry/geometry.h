#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "math/bounds.h"
#include "math/ray.h"

namespace etendue {

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// Bound of a surface point's rounding error, as a share of the largest coordinate that it was computed from: barycentric interpolation of
/// three vertices in floats is within γ₇ ≈ 7·2⁻²⁴ of exact (Higham 2002, section 3.1); the ray that comes back rounds as much again, and
/// Embree's t adds its own.
inline constexpr float kRelativeError = 32 * 0x1p-24f;

/// Triangles in world space. The front of a triangle is the side from which its vertices run counter-clockwise.
struct TriangleMesh {
  std::vector<Point3> positions;
  std::vector<Vec3> normals;  ///< empty: flat; else one a vertex, unit
  std::vector<Vec2> uvs;      ///< empty: none; else one a vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A sphere in world space; its front is the outside.
struct SphereShape {
  Point3 center;
  float radius = 1;
  Vec3 pole{0, 1, 0};      ///< unit; where v = 1 of its texture coordinates
  Vec3 meridian{1, 0, 0};  ///< unit, perpendicular to the pole; where u = ½
};

/// What a ray meets first: enough to find out more, as small as possible.
struct RayHit {
  float t = 0;                    ///< distance in units of the ray's direction
  float u = 0, v = 0;             ///< weights of the triangle's second and third vertex
  std::uint32_t shape = kNone;    ///< index of the shape, in order of addition; kNone: nothing was hit
  std::uint32_t primitive = 0;    ///< triangle within the mesh

  bool found() const { return shape != kNone; }
};

/// A point on a surface.
struct SurfaceHit {
  Point3 position;
  Vec3 geometric_normal;  ///< unit, on the front
  Vec3 shading_normal;    ///< unit, in the same hemisphere as the geometric one
  float error = 0;        ///< bound of the position's rounding error: how far a ray must start off the surface
};

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

  /// Both return the shape's index.
  std::uint32_t add(TriangleMesh mesh);
  std::uint32_t add(const SphereShape& sphere);
  /// Builds the acceleration structure; once, after all shapes were added. Throws Error(Failure::input) when memory does not suffice.
  void build();

  RayHit intersect(const Ray& ray) const;
  /// The same for up to kBatch rays that start close to each other and run in similar directions.
  void intersect_coherent(std::span<const Ray> rays, std::span<RayHit> hits) const;
  /// For up to kBatch rays: bit i of the result is set when something lies on rays[i] between its t_min and t_max.
  std::uint32_t occluded(std::span<const Ray> rays) const;

  /// Position and normals where `ray` met something.
  SurfaceHit surface(const Ray& ray, const RayHit& hit) const;
  /// Texture coordinates there: the mesh's, or its barycentric weights if it has none; on a sphere longitude and latitude, v up.
  Vec2 texture_coordinates(const RayHit& hit, const SurfaceHit& surface) const;

  /// From now on `recorder` sees all rays; nullptr: none does. Not while rays are traced.
  void set_recorder(RayRecorder* recorder) { recorder_ = recorder; }

  bool is_sphere(std::uint32_t shape) const { return shapes_[shape].is_sphere; }
  const TriangleMesh& mesh(std::uint32_t shape) const { return meshes_[shapes_[shape].index]; }
  const SphereShape& sphere(std::uint32_t shape) const { return spheres_[shapes_[shape].index]; }
  std::size_t shape_count() const { return shapes_.size(); }
  std::size_t triangle_count() const { return triangle_count_; }
  std::size_t sphere_count() const { return spheres_.size(); }
  const Bounds3& bounds() const { return bounds_; }

 private:
  struct Shape {
    bool is_sphere;
    std::uint32_t index;
  };
  struct Embree;

  std::vector<Shape> shapes_;
  std::vector<TriangleMesh> meshes_;
  std::vector<SphereShape> spheres_;
  std::size_t triangle_count_ = 0;
  Bounds3 bounds_;
  std::unique_ptr<Embree> embree_;
  RayRecorder* recorder_ = nullptr;
};

/// Start of a ray that leaves `hit` into `direction`: off the surface, on the side that the direction points to, by more than the
/// rounding errors of the position and less than anything that is seen.
inline Point3 offset_origin(const SurfaceHit& hit, const Vec3& direction) {
  const float side = dot(hit.geometric_normal, direction) < 0 ? -hit.error : hit.error;
  return hit.position + hit.geometric_normal * side;
}

}  // namespace etendue
