#include "render/shape_compiler.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

namespace etendue {
namespace {

/// Triangles below this, in square metres, lie at the end of float arithmetic: twice their area squared nears the
/// smallest of floats.
constexpr float kTinyArea = 1e-18f;

/// How many triangles of a scene are not what they should be.
struct TriangleRepairs {
  std::size_t dropped = 0, tiny = 0;
};

/// The attribute without the values of triangles that were dropped.
MeshAttribute compile_attribute(const scene::MeshAttribute& a, const std::vector<std::size_t>& kept_triangles) {
  MeshAttribute out{a.name, a.per_face, a.channels, {}};
  if (!a.per_face) {
    out.values = a.values;
    return out;
  }
  for (const std::size_t triangle : kept_triangles)
    for (int c = 0; c < a.channels; ++c) out.values.push_back(a.values[triangle * a.channels + c]);
  return out;
}

/// The mesh in world space. Its winding is made to agree with its normals, so that the front is on their side; normals
/// that say no more than the triangles themselves are left out. Triangles without area or out of reach are dropped and
/// counted, tiny ones counted.
TriangleMesh to_world(const scene::Mesh& mesh, const Transform& m, TriangleRepairs& repairs) {
  TriangleMesh out;
  out.positions.reserve(mesh.positions.size() + 2);
  for (const Point3& p : mesh.positions) out.positions.push_back(m.point(p));
  const bool mirrored = m.determinant() < 0;
  const float sign = mirrored ? -1.0f : 1.0f;
  for (const Vec3& n : mesh.normals) out.normals.push_back(normalize(m.normal(n) * sign));
  out.uvs = mesh.uvs;
  out.triangles.reserve(mesh.triangles.size());
  bool smooth = false;
  std::vector<std::size_t> kept;
  for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
    auto t = mesh.triangles[index];
    if (mirrored) std::swap(t[1], t[2]);
    const Point3 &p0 = out.positions[t[0]], &p1 = out.positions[t[1]], &p2 = out.positions[t[2]];
    const Vec3 n = cross(p1 - p0, p2 - p0);
    const float l = length(n);
    if (!(l > 0) || !std::isfinite(l) || is_out_of_reach(p0) || is_out_of_reach(p1) || is_out_of_reach(p2)) {
      ++repairs.dropped;
      continue;
    }
    repairs.tiny += 0.5f * l < kTinyArea ? 1 : 0;
    if (!out.normals.empty()) {
      const Vec3 unit = n * (1 / l);
      const float a = dot(unit, out.normals[t[0]]), b = dot(unit, out.normals[t[1]]), c = dot(unit, out.normals[t[2]]);
      if (a + b + c < 0) std::swap(t[1], t[2]);
      smooth = smooth || std::min({std::abs(a), std::abs(b), std::abs(c)}) < 1 - 1e-6f;
    }
    out.triangles.push_back(t);
    if (!mesh.attributes.empty()) kept.push_back(index);
  }
  if (!smooth) out.normals = {};
  for (const scene::MeshAttribute& attribute : mesh.attributes)
    out.attributes.push_back(compile_attribute(attribute, kept));
  return out;
}

class ShapeCompiler {
 public:
  ShapeCompiler(const scene::SceneDescription& description, RenderScene::Data& data, Diagnostics& diagnostics)
      : scene_(description), data_(data), diagnostics_(diagnostics), groups_(description.groups.size()) {}

  void run() {
    for (std::uint32_t i = 0; i < scene_.groups.size(); ++i) compile_group(i);
    data_.first_shape_of_instance.assign(scene_.instances.size(), kNone);
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const auto first = static_cast<std::uint32_t>(data_.geometry.shape_count());
      place(scene_.instances[i]);
      if (data_.geometry.shape_count() > first) data_.first_shape_of_instance[i] = first;
    }
    diagnostics_.repaired("triangle without area or beyond 1e12 m left out", {}, repairs_.dropped);
    diagnostics_.repaired("triangle below 1e-18 m² rendered with few exact digits: a larger <unit> helps", {},
                          repairs_.tiny);
    diagnostics_.repaired("light on a shape of a group left out: only shapes in no group can shine", {}, dark_lamps_);
  }

 private:
  /// A group's own shapes, and the groups that it holds.
  struct CompiledGroup {
    std::optional<std::uint32_t> geometry;  ///< nothing if it has no shapes of its own
    std::vector<const scene::Instance*> inner;
  };

  void compile_group(std::uint32_t index) {
    CompiledGroup& group = groups_[index];
    const auto first = data_.geometry.shape_count();
    std::vector<const scene::Instance*> own;
    for (const scene::Instance& instance : scene_.groups[index].instances)
      (std::holds_alternative<scene::Id<scene::Group>>(instance.shape) ? group.inner : own).push_back(&instance);
    if (own.empty()) return;
    group.geometry = data_.geometry.begin_group();
    in_group_ = true;
    for (const scene::Instance* instance : own) place(*instance);
    in_group_ = false;
    data_.geometry.end_group();
    if (data_.geometry.shape_count() == first) group.geometry.reset();
  }

  void place(const scene::Instance& instance) {
    std::visit([&](const auto& id) { place_shape(instance, id); }, instance.shape);
  }

  void place_shape(const scene::Instance& instance, scene::Id<scene::Group> id) {
    place_group(instance, id.index, instance.to_world, 0);
  }

  /// Groups in groups become instances of their own.
  void place_group(const scene::Instance& instance, std::uint32_t index, const Transform& to_world, std::size_t depth) {
    if (depth > groups_.size()) {
      diagnostics_.repaired("group that contains itself left out", instance.where);
      return;
    }
    const CompiledGroup& group = groups_[index];
    if (group.geometry) {
      if (!can_place(to_world) || is_out_of_reach(to_world.origin))
        diagnostics_.repaired("instance without extent or beyond 1e12 m left out", instance.where);
      else
        data_.geometry.add_instance(*group.geometry, to_world);
    }
    for (const scene::Instance* inner : group.inner)
      place_group(*inner, std::get<scene::Id<scene::Group>>(inner->shape).index, to_world * inner->to_world, depth + 1);
  }

  void place_shape(const scene::Instance& instance, scene::Id<scene::Sphere> id) {
    const Transform& m = instance.to_world;
    const float radius = scene_.spheres[id.index].radius * std::cbrt(std::abs(m.determinant()));
    if (!(radius > 0) || !std::isfinite(radius) || !is_finite(m.origin)) {
      diagnostics_.repaired("sphere without extent left out", instance.where);
      return;
    }
    if (is_out_of_reach(m.origin) || radius > kReach) {
      diagnostics_.repaired("sphere that reaches beyond 1e12 m left out", instance.where);
      return;
    }
    const Vec3 pole = normalize(m.y);
    add(instance, SphereShape{m.origin, radius, pole, normalize(m.x - pole * dot(m.x, pole)), instance.flip_normals,
                              m.determinant() < 0});
  }
  void place_shape(const scene::Instance& instance, scene::Id<scene::Mesh> id) {
    TriangleMesh mesh = to_world(scene_.meshes[id.index], instance.to_world, repairs_);
    if (mesh.triangles.empty()) return;
    add(instance, std::move(mesh));
  }
  void place_shape(const scene::Instance& instance, scene::Id<scene::Disk>) {
    if (is_placeable(instance)) add(instance, DiskShape{instance.to_world, instance.flip_normals});
  }
  void place_shape(const scene::Instance& instance, scene::Id<scene::Cylinder>) {
    if (is_placeable(instance)) add(instance, CylinderShape{instance.to_world, instance.flip_normals});
  }
  void place_shape(const scene::Instance& instance, scene::Id<scene::Curves> id) {
    const scene::Curves& curves = scene_.curves[id.index];
    CurvesShape out;
    out.basis = curves.basis == scene::Curves::Basis::linear ? CurvesShape::Basis::linear : CurvesShape::Basis::bspline;
    const float scale = std::cbrt(std::abs(instance.to_world.determinant()));
    for (std::size_t i = 0; i < curves.positions.size(); ++i) {
      out.points.push_back({instance.to_world.point(curves.positions[i]), curves.radii[i] * scale});
      if (!is_out_of_reach(out.points.back().position) && out.points.back().radius >= 0) continue;
      diagnostics_.repaired("curve with a point beyond 1e12 m or a negative radius left out", instance.where);
      return;
    }
    out.segments = curves.segments;
    if (!out.segments.empty() && is_placeable(instance)) add(instance, std::move(out));
  }

  bool is_placeable(const scene::Instance& instance) {
    if (can_place(instance.to_world) && !is_out_of_reach(instance.to_world.origin)) return true;
    diagnostics_.repaired("shape without extent or beyond 1e12 m left out", instance.where);
    return false;
  }

  template <typename Shape>
  void add(const scene::Instance& instance, Shape shape) {
    RenderScene::Data::ShapeInfo info;
    info.material = instance.material.index;
    if (instance.separates_media) {
      info.separates_media = true;
      if (instance.interior) info.interior = instance.interior->index;
      if (instance.exterior) info.exterior = instance.exterior->index;
    }
    if (in_group_ && scene::emits(scene_.materials[info.material])) ++dark_lamps_;
    info.in_group = in_group_;
    data_.geometry.add(std::move(shape));
    data_.shapes.push_back(info);
  }

  const scene::SceneDescription& scene_;
  RenderScene::Data& data_;
  Diagnostics& diagnostics_;
  std::vector<CompiledGroup> groups_;
  bool in_group_ = false;
  TriangleRepairs repairs_;
  std::size_t dark_lamps_ = 0;
};

}  // namespace

void compile_shapes(const scene::SceneDescription& scene, RenderScene::Data& data, Diagnostics& diagnostics) {
  ShapeCompiler(scene, data, diagnostics).run();
}

}  // namespace etendue
