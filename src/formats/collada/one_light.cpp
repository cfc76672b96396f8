#include "formats/collada/one_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "formats/collada/document.h"
#include "math/bounds.h"

namespace etendue::collada {
namespace {

constexpr float kRadianceTolerance = 1e-3f;  ///< relative
constexpr float kParallelCosine = 0.999f;    ///< normals closer than 2.6°
constexpr float kLeastOverlap = 0.25f;       ///< share of the smaller of the two areas

bool same_radiance(const Spectrum& a, const Spectrum& b) {
  const Spectrum difference = a - b;
  const float most = kRadianceTolerance * std::max(a.max(), b.max());
  return std::abs(difference.r) <= most && std::abs(difference.g) <= most && std::abs(difference.b) <= most;
}

/// The part of a convex polygon where ±component ≤ ½ (Sutherland & Hodgman 1974).
std::vector<Vec2> clipped(const std::vector<Vec2>& polygon, int component, float sign) {
  std::vector<Vec2> inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const float da = 0.5f - sign * a[component], db = 0.5f - sign * b[component];
    if (da >= 0) inside.push_back(a);
    if ((da >= 0) != (db >= 0)) inside.push_back(a + (b - a) * (da / (da - db)));
  }
  return inside;
}

float area(const std::vector<Vec2>& polygon) {
  float twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) twice += polygon[i].cross(polygon[(i + 1) % polygon.size()]);
  return std::abs(twice) / 2;
}

/// A rectangle light in the world, and how much of emissive meshes covers it.
class Rectangle {
 public:
  explicit Rectangle(const Transform& to_world)
      : center_(to_world.origin),
        half_diagonal_((length(to_world.x) + length(to_world.y)) / 2),
        slack_(0.02f * std::max(length(to_world.x), length(to_world.y))) {
    const Vec3 across = cross(to_world.x, to_world.y);
    front_ = normalize(dot(across, to_world.z) > 0 ? -across : across);
    to_local_ = Transform{to_world.x, to_world.y, front_, center_}.inverse();
  }

  bool may_touch(const Bounds3& box) const {
    const float reach = half_diagonal_ + slack_;
    for (int i = 0; i < 3; ++i)
      if (center_[i] + reach < box.min[i] || center_[i] - reach > box.max[i]) return false;
    return true;
  }

  /// Whether enough of the mesh's surface lies on the rectangle.
  bool is_covered_by(const scene::Mesh& mesh, const Transform& mesh_to_world) const {
    float in_plane = 0, overlap = 0;  // in units of the rectangle's area
    for (const auto& triangle : mesh.triangles) {
      std::array<Point3, 3> p;
      for (std::size_t i = 0; i < 3; ++i) p[i] = mesh_to_world.point(mesh.positions[triangle[i]]);
      const Vec3 normal = facing(mesh, triangle, mesh_to_world, p);
      if (!(dot(normal, front_) > kParallelCosine * length(normal))) continue;
      std::vector<Vec2> flat;
      for (const Point3& corner : p) {
        const Point3 local = to_local_.point(corner);
        if (std::abs(local.z) <= slack_) flat.push_back({local.x, local.y});
      }
      if (flat.size() < 3) continue;
      in_plane += area(flat);
      for (const int component : {0, 1})
        for (const float sign : {1.0f, -1.0f}) flat = clipped(flat, component, sign);
      overlap += area(flat);
    }
    return overlap > 0 && overlap >= kLeastOverlap * std::min(1.0f, in_plane);
  }

 private:
  /// The triangle's geometric normal, on the side of its vertex normals if it has them.
  static Vec3 facing(const scene::Mesh& mesh, const std::array<std::uint32_t, 3>& triangle, const Transform& to_world,
                     const std::array<Point3, 3>& p) {
    const Vec3 geometric = cross(p[1] - p[0], p[2] - p[0]);
    const float mirrored = to_world.determinant() < 0 ? -1.0f : 1.0f;
    if (mesh.normals.empty()) return geometric * mirrored;
    const Vec3 shading = to_world.normal(mesh.normals[triangle[0]]) * mirrored;
    return dot(shading, geometric) < 0 ? -geometric : geometric;
  }

  Point3 center_;
  float half_diagonal_, slack_;
  Vec3 front_;
  Transform to_local_;
};

/// An emissive mesh in the world.
struct Lamp {
  const scene::Instance* instance;
  const scene::Mesh* mesh;
  Spectrum radiance;
  Bounds3 bounds;
};

std::vector<Lamp> emissive_meshes(const scene::SceneDescription& scene) {
  std::vector<Lamp> lamps;
  for (const scene::Instance& instance : scene.instances) {
    const auto* id = std::get_if<scene::Id<scene::Mesh>>(&instance.shape);
    const auto* emission = std::get_if<Spectrum>(&scene.materials[instance.material.index].emission);
    if (id == nullptr || emission == nullptr || emission->is_black()) continue;
    const scene::Mesh& mesh = scene.meshes[id->index];
    Lamp lamp{&instance, &mesh, *emission, {}};
    for (const Point3& p : mesh.positions) lamp.bounds.extend(instance.to_world.point(p));
    lamps.push_back(lamp);
  }
  return lamps;
}

/// The lamp that covers the rectangle; one of the same radiance if there is any.
std::vector<Lamp>::const_iterator find_covering(const std::vector<Lamp>& lamps, const Rectangle& rectangle,
                                                const Spectrum& radiance) {
  auto found = lamps.end();
  for (auto lamp = lamps.begin(); lamp != lamps.end(); ++lamp) {
    if (!rectangle.may_touch(lamp->bounds) || !rectangle.is_covered_by(*lamp->mesh, lamp->instance->to_world)) continue;
    if (same_radiance(lamp->radiance, radiance)) return lamp;
    found = lamp;
  }
  return found;
}

}  // namespace

std::vector<scene::Light> without_doubled_lights(const scene::SceneDescription& scene, Report& report) {
  const bool has_rectangle = std::any_of(scene.lights.begin(), scene.lights.end(), [](const scene::Light& light) {
    return std::holds_alternative<scene::RectangleLight>(light.source);
  });
  if (!has_rectangle) return scene.lights;

  const std::vector<Lamp> lamps = emissive_meshes(scene);
  std::vector<scene::Light> kept;
  for (const scene::Light& light : scene.lights) {
    const auto* source = std::get_if<scene::RectangleLight>(&light.source);
    const auto lamp =
        source == nullptr ? lamps.end() : find_covering(lamps, Rectangle(light.to_world), source->radiance);
    if (lamp == lamps.end()) {
      kept.push_back(light);
    } else if (same_radiance(lamp->radiance, source->radiance)) {
      report.info_once(fmt::format("the area light {} and the emissive mesh {} are one light: the mesh is kept",
                                   in_quotes(light.name), in_quotes(lamp->instance->name)),
                       light.where);
    } else {
      report.warning(
          fmt::format(
              "the area light {} (radiance {} {} {}) lies on the emissive mesh {} (radiance {} {} {}): one place "
              "holds one light, and what is seen is kept, the mesh",
              in_quotes(light.name), source->radiance.r, source->radiance.g, source->radiance.b,
              in_quotes(lamp->instance->name), lamp->radiance.r, lamp->radiance.g, lamp->radiance.b),
          light.where);
    }
  }
  return kept;
}

}  // namespace etendue::collada
