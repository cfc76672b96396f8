#include <cmath>

#include "lights/area_sampler.h"
#include "lights/light.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

/// As many small triangles as a light has at most, and as many parts as an edge is divided into at most.
constexpr std::size_t kMostParts = 1 << 16;
constexpr int kMostDivisions = 128;
/// What a small triangle without light in its middle counts for, in mean ones: its border may shine.
constexpr double kLeastShare = 0.05;

/// A part of a triangle that is divided `n` by `n`: the cell (i, j), its half before or behind the diagonal. Cells lie
/// row by row.
struct Part {
  int i, j;
  bool upper;

  static Part at(int index, int n) {
    int i = 0;
    while (index >= 2 * (n - i) - 1) index -= 2 * (n - i++) - 1;
    return {i, index / 2, index % 2 == 1};
  }
  static Part holding(float b1, float b2, int n) {
    const float x = std::clamp(b1, 0.0f, 1.0f) * static_cast<float>(n),
                y = std::clamp(b2, 0.0f, 1.0f) * static_cast<float>(n);
    const int i = std::min(static_cast<int>(x), n - 1), j = std::min(static_cast<int>(y), n - 1 - i);
    const bool upper = x - static_cast<float>(i) + (y - static_cast<float>(j)) > 1 && i + j < n - 1;
    return {i, j, upper};
  }
  int index(int n) const { return i * (2 * n - i) + 2 * j + (upper ? 1 : 0); }
  /// The whole triangle's barycentric weights of a point given by the part's.
  Vec2 whole(Vec2 b, int n) const {
    const Vec2 in_cell = upper ? Vec2(1 - b.x, 1 - b.y) : b;
    return Vec2(static_cast<float>(i) + in_cell.x, static_cast<float>(j) + in_cell.y) * (1 / static_cast<float>(n));
  }
};

std::uint32_t square_of(int n) {
  return static_cast<std::uint32_t>(n * n);
}

/// The way from `from` to a point of a surface that was chosen with this density by area.
std::optional<LightSample> seen_from(const Point3& from, const SurfaceHit& surface, float pdf_area) {
  const Vec3 d = surface.position - from;
  const float d2 = length_squared(d), distance = std::sqrt(d2);
  const Vec3 wi = d * (1 / distance);
  const float cosine = -dot(wi, surface.geometric_normal);
  const float pdf = pdf_area * d2 / cosine;
  if (!(cosine > 0) || !std::isfinite(pdf) || !(pdf > 0)) return std::nullopt;
  return LightSample{wi, distance, {}, pdf, false, surface.geometric_normal, surface.error};
}

float to_solid_angle(const Point3& from, const LightHit& hit, float pdf_area) {
  const Vec3 d = hit.position - from;
  const float d2 = length_squared(d), cosine = -dot(d, hit.normal) / std::sqrt(d2);
  return cosine > 0 ? pdf_area * d2 / cosine : 0.0f;
}

}  // namespace

Spectrum Glow::at(const RayHit& hit, const SurfaceHit& surface) const {
  if (const Spectrum* constant = std::get_if<Spectrum>(&radiance)) return *constant;
  return evaluate_color(radiance, *textures,
                        {geometry->texture_coordinates(hit, surface), surface.position, geometry, hit});
}

TexturedMeshLight::TexturedMeshLight(const Glow& glow_in) : glow(glow_in) {
  const TriangleMesh& mesh = glow.geometry->mesh(glow.shape);
  const std::size_t count = mesh.triangles.size();
  divisions = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(kMostParts) / static_cast<double>(count))), 1,
                         kMostDivisions);
  const int divided = divisions * divisions;
  std::vector<double> weights;
  weights.reserve(count * divided);
  double total = 0, area = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    areas.push_back(0.5f * length(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])));
    for (int p = 0; p < divided; ++p) {
      const Part part = Part::at(p, divisions);
      double luminance = 0;
      for (const Vec2& inner : {Vec2(1 / 6.0f, 1 / 6.0f), Vec2(2 / 3.0f, 1 / 6.0f), Vec2(1 / 6.0f, 2 / 3.0f)}) {
        const AreaPoint point = mesh_point(*glow.geometry, glow.shape, t, part.whole(inner, divisions));
        luminance += glow.at(point.hit, point.surface).luminance() / 3;
      }
      weights.push_back(luminance * areas.back() / divided);
      total += weights.back();
    }
    area += areas.back();
  }
  flux = static_cast<float>(total);
  const double least = kLeastShare * (total > 0 ? total / area : 1.0);
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] += least * areas[i / divided] / divided;
  parts = DiscreteDistribution(weights);
}

AreaPoint TexturedMeshLight::sample_area(Vec2 u, float choice) const {
  const DiscreteDistribution::Sample chosen = parts.sample(choice);
  AreaPoint point = point_on(static_cast<std::uint32_t>(chosen.index), sample_triangle_uniform(u));
  point.pdf_area = chosen.probability / part_area(point.hit.primitive);
  return point;
}

float TexturedMeshLight::pdf_area(const LightHit& hit) const {
  return parts.probability(part_at(hit)) / part_area(hit.primitive);
}

std::optional<LightSample> TexturedMeshLight::sample(std::uint32_t part, const Point3& from, Vec2 u) const {
  const AreaPoint point = point_on(part, sample_triangle_uniform(u));
  std::optional<LightSample> sample = seen_from(from, point.surface, 1 / part_area(point.hit.primitive));
  if (sample) sample->radiance = glow.at(point.hit, point.surface);
  return sample;
}

float TexturedMeshLight::pdf_hit(const Point3& from, const LightHit& hit) const {
  return to_solid_angle(from, hit, 1 / part_area(hit.primitive));
}

std::uint32_t TexturedMeshLight::part_at(const LightHit& hit) const {
  const int within = Part::holding(hit.u, hit.v, divisions).index(divisions);
  return hit.primitive * square_of(divisions) + static_cast<std::uint32_t>(within);
}

LightBounds TexturedMeshLight::bounds(std::uint32_t part) const {
  LightBounds out;
  for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}) {
    const AreaPoint point = point_on(part, corner);
    out.box.extend(point.surface.position);
    out.normals.axis = point.surface.geometric_normal;
  }
  out.intensity = parts.probability(part) * flux;
  return out;
}

/// The point of a part with these weights of its second and third corner.
AreaPoint TexturedMeshLight::point_on(std::uint32_t part, Vec2 weights) const {
  const std::uint32_t parts_each = square_of(divisions);
  const Part within = Part::at(static_cast<int>(part % parts_each), divisions);
  return mesh_point(*glow.geometry, glow.shape, part / parts_each, within.whole(weights, divisions));
}

float TexturedMeshLight::part_area(std::uint32_t triangle) const {
  return areas[triangle] / static_cast<float>(square_of(divisions));
}

float TexturedMeshLight::power(const Bounds3&) const {
  return kPi * flux;
}

CurvedLight::CurvedLight(const Glow& glow_in) : glow(glow_in) {
  constexpr int kGrid = 16;
  double sum = 0;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) {
      const AreaPoint p = sample_curved(
          *glow.geometry, glow.shape, {(static_cast<float>(i) + 0.5f) / kGrid, (static_cast<float>(j) + 0.5f) / kGrid});
      sum += glow.at(p.hit, p.surface).luminance() / p.pdf_area;
    }
  flux = static_cast<float>(sum / (kGrid * kGrid));
}

std::optional<LightSample> CurvedLight::sample(const Point3& from, Vec2 u) const {
  const AreaPoint point = sample_curved(*glow.geometry, glow.shape, u);
  std::optional<LightSample> sample = seen_from(from, point.surface, point.pdf_area);
  if (sample) sample->radiance = glow.at(point.hit, point.surface);
  return sample;
}

float CurvedLight::pdf_area(const LightHit& hit) const {
  const Geometry& geometry = *glow.geometry;
  switch (geometry.kind(glow.shape)) {
    case Geometry::Kind::disk: {
      const ShapePoint p = point_at(geometry.disk(glow.shape), hit.u, hit.v);
      return disk_pdf() / length(cross(p.dp_da, p.dp_db));
    }
    case Geometry::Kind::cylinder: {
      const ShapePoint p = point_at(geometry.cylinder(glow.shape), hit.u, hit.v);
      return 1 / length(cross(p.dp_da, p.dp_db));
    }
    default:
      return sphere_uniform_pdf() / square(geometry.sphere(glow.shape).radius);
  }
}

float CurvedLight::pdf_hit(const Point3& from, const LightHit& hit) const {
  return to_solid_angle(from, hit, pdf_area(hit));
}

float CurvedLight::power(const Bounds3&) const {
  return kPi * flux;
}

LightBounds CurvedLight::bounds() const {
  const Geometry& geometry = *glow.geometry;
  switch (geometry.kind(glow.shape)) {
    case Geometry::Kind::disk: {
      const DiskShape& disk = geometry.disk(glow.shape);
      return {bounds_of(disk), {point_at(disk, 0, 0).normal, 0}, 0, flux};
    }
    case Geometry::Kind::cylinder:
      return {bounds_of(geometry.cylinder(glow.shape)), DirectionCone::all(), 0, flux * kInvPi};
    default: {
      const SphereShape& sphere = geometry.sphere(glow.shape);
      return {{sphere.center - Vec3(sphere.radius), sphere.center + Vec3(sphere.radius)},
              DirectionCone::all(),
              0,
              flux * 0.25f};
    }
  }
}

}  // namespace etendue
