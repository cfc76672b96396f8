#include "geometry/geometry.h"
#include "lights/light.h"
#include "lights/spherical_triangle.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

/// Solid angle is worth its price where the triangle looms large (squared distance below this multiple of its area). Up
/// to where it fills nearly the whole half space its arithmetic holds.
constexpr float kFarRatio = 8;

bool by_solid_angle(const MeshLight::Triangle& t, const Point3& from, float height) {
  const Point3 center = (t.p0 + t.p1 + t.p2) * (1.0f / 3.0f);
  return length_squared(center - from) < kFarRatio * t.area && square(height) > 1e-4f * t.area;
}

float position_error(const MeshLight::Triangle& t) {
  return kRelativeError * std::max({max_abs_component(t.p0), max_abs_component(t.p1), max_abs_component(t.p2)});
}

/// Density by area turned into solid angle at distance² d2 and height over the plane: cos at the light = height / d.
float area_to_solid_angle(float d2, float height, float area) {
  return d2 * std::sqrt(d2) / (height * area);
}

}  // namespace

MeshLight::MeshLight(std::vector<Triangle> triangles_in, const Spectrum& emitted_in)
    : triangles(std::move(triangles_in)), emitted(emitted_in) {
  std::vector<double> areas;
  areas.reserve(triangles.size());
  for (const Triangle& t : triangles) areas.push_back(t.area);
  parts = DiscreteDistribution(areas);
}

std::optional<LightSample> MeshLight::sample(std::uint32_t part, const Point3& from, Vec2 u) const {
  const Triangle& t = triangles[part];
  const float height = dot(from - t.p0, t.normal);
  if (height <= 0) return std::nullopt;
  if (by_solid_angle(t, from, height)) {
    const SphericalTriangle seen(t.p0, t.p1, t.p2, from);
    if (seen.solid_angle() == 0) return std::nullopt;
    const Vec3 wi = seen.sample(u);
    const float cosine = -dot(wi, t.normal);
    if (cosine <= 0) return std::nullopt;
    return LightSample{wi, height / cosine, emitted, 1 / seen.solid_angle(), false, t.normal, position_error(t)};
  }
  const Vec2 b = sample_triangle_uniform(u);
  const Vec3 d = t.p0 * (1 - b.x - b.y) + t.p1 * b.x + t.p2 * b.y - from;
  const float d2 = length_squared(d), distance = std::sqrt(d2);
  const float pdf = area_to_solid_angle(d2, height, t.area);
  if (!std::isfinite(pdf) || pdf <= 0) return std::nullopt;
  return LightSample{d * (1 / distance), distance, emitted, pdf, false, t.normal, position_error(t)};
}

float MeshLight::pdf_hit(const Point3& from, const LightHit& hit) const {
  const Triangle& t = triangles[hit.primitive];
  const float height = dot(from - t.p0, t.normal);
  if (height <= 0) return 0;
  if (by_solid_angle(t, from, height)) {
    const float solid_angle = SphericalTriangle(t.p0, t.p1, t.p2, from).solid_angle();
    return solid_angle > 0 ? 1 / solid_angle : 0.0f;
  }
  return area_to_solid_angle(length_squared(hit.position - from), height, t.area);
}

std::uint32_t MeshLight::part_at(const LightHit& hit) const {
  return hit.primitive;
}

LightBounds MeshLight::bounds(std::uint32_t part) const {
  const Triangle& t = triangles[part];
  Bounds3 box;
  for (const Point3& p : {t.p0, t.p1, t.p2}) box.extend(p);
  return {box, {t.normal, 0}, 0, t.area * emitted.luminance()};
}

float MeshLight::power(const Bounds3&) const {
  float area = 0;
  for (const Triangle& t : triangles) area += t.area;
  return kPi * area * emitted.luminance();
}

}  // namespace etendue
