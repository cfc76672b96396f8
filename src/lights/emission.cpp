#include "lights/emission.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lights/area_sampler.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

/// A light of which little is expected still gets this share of the mean one's.
constexpr double kLeastShare = 0.05;
/// Places at which a light's view of the targets is looked at beforehand.
constexpr int kViews = 8;

float position_error(const Point3& p, float extent) {
  return kRelativeError * (max_abs_component(p) + extent);
}

LightPoint flat_point(const Point3& position, const Vec3& normal, float extent, const Spectrum& radiance, float pdf) {
  return {{position, normal, normal, position_error(position, extent)}, radiance, pdf};
}

std::optional<LightPoint> sample_point(const RectangleLight& light, Vec2 u, float) {
  const Rectangle& r = light.rectangle;
  return flat_point(r.corner + r.edge_x * u.x + r.edge_y * u.y, r.normal, r.length_x + r.length_y, light.emitted,
                    1 / r.area());
}
std::optional<LightPoint> sample_point(const MeshLight& light, Vec2 u, float choice) {
  const DiscreteDistribution::Sample chosen = light.parts.sample(choice);
  const MeshLight::Triangle& t = light.triangles[chosen.index];
  const Vec2 b = sample_triangle_uniform(u);
  const float extent = std::max({max_abs_component(t.p0), max_abs_component(t.p1), max_abs_component(t.p2)});
  return flat_point(t.p0 * (1 - b.x - b.y) + t.p1 * b.x + t.p2 * b.y, t.normal, extent, light.emitted,
                    chosen.probability / t.area);
}
std::optional<LightPoint> sample_point(const SphereLight& light, Vec2 u, float) {
  const Vec3 w = sample_sphere_uniform(u);
  return flat_point(light.center + w * light.radius, w, light.radius, light.emitted,
                    sphere_uniform_pdf() / square(light.radius));
}
std::optional<LightPoint> sample_point(const TexturedMeshLight& light, Vec2 u, float choice) {
  const AreaPoint point = light.sample_area(u, choice);
  return LightPoint{point.surface, light.glow.at(point.hit, point.surface), point.pdf_area};
}
std::optional<LightPoint> sample_point(const CurvedLight& light, Vec2 u, float) {
  const AreaPoint point = sample_curved(*light.glow.geometry, light.glow.shape, u);
  return LightPoint{point.surface, light.glow.at(point.hit, point.surface), point.pdf_area};
}
std::optional<LightPoint> sample_point(const auto&, Vec2, float) {
  return std::nullopt;
}

float point_pdf(const RectangleLight& light, const LightHit&) {
  return 1 / light.rectangle.area();
}
float point_pdf(const MeshLight& light, const LightHit& hit) {
  return light.parts.probability(hit.primitive) / light.triangles[hit.primitive].area;
}
float point_pdf(const SphereLight& light, const LightHit&) {
  return sphere_uniform_pdf() / square(light.radius);
}
float point_pdf(const TexturedMeshLight& light, const LightHit& hit) {
  return light.pdf_area(hit);
}
float point_pdf(const CurvedLight& light, const LightHit& hit) {
  return light.pdf_area(hit);
}
float point_pdf(const auto&, const LightHit&) {
  return 0;
}

float disk_area(float radius) {
  return kPi * square(radius);
}

}  // namespace

std::optional<LightPoint> sample_light_point(const Light& light, Vec2 u, float choice) {
  return std::visit([&](const auto& l) { return sample_point(l, u, choice); }, light);
}

float light_point_pdf(const Light& light, const LightHit& hit) {
  return std::visit([&](const auto& l) { return point_pdf(l, hit); }, light);
}

/// A target as seen from a point of a surface, and how much light is sent to it.
struct LightAim::Cone {
  Vec3 axis{0, 0, 1};  ///< unit
  float one_minus_cos = 0;
  float sin2 = 0;
  bool around = false;  ///< the target is all around: light goes everywhere, by the cosine
  float weight = 0;

  bool holds(const Vec3& w) const { return dot(w, axis) > 0 && length_squared(cross(w, axis)) <= sin2; }
  float pdf(const Vec3& w, float cosine) const {
    if (around) return cosine * kInvPi;
    return holds(w) ? cone_uniform_pdf(one_minus_cos) : 0.0f;
  }
};

LightAim::Cone LightAim::cone(const AimTarget& target, const Point3& from, const Vec3& normal) const {
  const Vec3 d = target.center - from;
  if (dot(d, normal) <= -target.radius) return {};
  const float d2 = length_squared(d), sin2 = square(target.radius) / d2;
  Cone out;
  out.around = !(sin2 < 0.9f);
  out.weight = 1;
  if (out.around) return out;
  out.axis = d * (1 / std::sqrt(d2));
  out.sin2 = sin2;
  out.one_minus_cos = sin2 / (1 + std::sqrt(1 - sin2));
  out.weight = out.one_minus_cos;
  return out;
}

LightAim::LightAim(const std::vector<Light>& lights, std::vector<AimTarget> targets, const Bounds3& scene)
    : lights_(&lights), targets_(std::move(targets)), scene_(scene) {
  std::vector<double> cross_sections;
  double cross_section = 0;
  for (const AimTarget& t : targets_) cross_section += cross_sections.emplace_back(disk_area(t.radius));
  by_disk_ = DiscreteDistribution(cross_sections);
  std::vector<double> shares(lights.size());
  double sum = 0;
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    if (is_delta(lights[i])) continue;
    const double power = light_power(lights[i], scene_);
    if (is_infinite(lights[i])) {
      shares[i] = power * cross_section / disk_area(0.5f * scene_.diagonal());
    } else {
      for (int v = 0; v < kViews; ++v) {
        const float u = (static_cast<float>(v) + 0.5f) / kViews;
        const auto point = sample_light_point(lights[i], {u, std::fmod(u * 5, 1.0f)}, std::fmod(u * 3, 1.0f));
        double seen = 0;
        for (const AimTarget& t : targets_)
          if (point) seen += 2 * cone(t, point->surface.position, point->surface.geometric_normal).weight;
        shares[i] += power * std::min(1.0, seen) / kViews;
      }
    }
    sum += shares[i];
  }
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    if (is_delta(lights[i]) || !(light_power(lights[i], scene_) > 0)) continue;
    shares[i] += kLeastShare * sum / static_cast<double>(lights.size());
    if (shares[i] > 0) can_send_ = true;
  }
  if (can_send_) choice_ = DiscreteDistribution(shares);
}

std::optional<EmittedRay> LightAim::sample(Vec2 which, Vec2 position, Vec2 direction, float target) const {
  const DiscreteDistribution::Sample chosen = choice_.sample(which.x);
  const Light& light = (*lights_)[chosen.index];
  std::optional<EmittedRay> out = is_infinite(light) ? arrive(light, position, direction, target)
                                                     : leave(light, which.y, position, direction, target);
  if (out) {
    out->density *= chosen.probability;
    out->light = static_cast<std::uint32_t>(chosen.index);
  }
  return out && out->density > 0 && std::isfinite(out->density) ? out : std::nullopt;
}

std::optional<EmittedRay> LightAim::leave(const Light& light, float part, Vec2 position, Vec2 direction,
                                          float target) const {
  const std::optional<LightPoint> point = sample_light_point(light, position, part);
  if (!point || point->radiance.is_black()) return std::nullopt;
  const Vec3& normal = point->surface.geometric_normal;
  const std::optional<Direction> to = this->direction(point->surface.position, normal, direction, target);
  if (!to) return std::nullopt;
  return EmittedRay{
      {offset_origin(point->surface, to->w), to->w}, point->radiance, point->pdf_area * to->pdf / dot(to->w, normal)};
}

std::optional<LightAim::Direction> LightAim::direction(const Point3& from, const Vec3& normal, Vec2 u,
                                                       float target) const {
  std::array<Cone, kMostTargets> cones;
  float sum = 0;
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    cones[t] = cone(targets_[t], from, normal);
    sum += cones[t].weight;
  }
  if (sum == 0) return std::nullopt;
  std::size_t chosen = 0;
  float rest = target * sum;
  while (chosen + 1 < targets_.size() && rest >= cones[chosen].weight) rest -= cones[chosen++].weight;
  const Cone& to = cones[chosen];
  const Vec3 w = to.around ? Frame::from_normal(normal).to_world(sample_hemisphere_cosine(u))
                           : Frame::from_normal(to.axis).to_world(sample_cone_uniform(u, to.one_minus_cos));
  const float cosine = dot(w, normal);
  if (cosine <= 0) return std::nullopt;
  float pdf = 0;
  for (std::size_t t = 0; t < targets_.size(); ++t) pdf += cones[t].weight * cones[t].pdf(w, cosine);
  return Direction{w, pdf / sum};
}

float LightAim::direction_pdf(const Point3& from, const Vec3& normal, const Vec3& w) const {
  const float cosine = dot(w, normal);
  if (cosine <= 0) return 0;
  float sum = 0, pdf = 0;
  for (const AimTarget& target : targets_) {
    const Cone to = cone(target, from, normal);
    sum += to.weight;
    if (to.weight > 0) pdf += to.weight * to.pdf(w, cosine);
  }
  return sum > 0 ? pdf / sum : 0.0f;
}

std::optional<EmittedRay> LightAim::arrive(const Light& light, Vec2 position, Vec2 direction, float target) const {
  const std::optional<LightSample> sky = sample_light(light, 0, scene_.center(), direction);
  if (!sky || sky->radiance.is_black()) return std::nullopt;
  const AimTarget& to = targets_[by_disk_.sample(target).index];
  const Vec2 on_disk = sample_disk_concentric(position) * to.radius;
  const Point3 through = to.center + Frame::from_normal(sky->wi).to_world({on_disk.x, on_disk.y, 0});
  return EmittedRay{
      {through + sky->wi * (2 * scene_.diagonal()), -sky->wi}, sky->radiance, sky->pdf * disk_pdf(through, sky->wi)};
}

/// Density per area across `w` with which arrive() sends a ray through `position`.
float LightAim::disk_pdf(const Point3& position, const Vec3& w) const {
  float pdf = 0;
  for (std::size_t t = 0; t < targets_.size(); ++t)
    if (length_squared(cross(position - targets_[t].center, w)) <= square(targets_[t].radius))
      pdf += by_disk_.probability(t) / disk_area(targets_[t].radius);
  return pdf;
}

float LightAim::density(std::uint32_t light, const LightHit& hit, const Vec3& w) const {
  if (!can_send_) return 0;
  const float cosine = dot(w, hit.normal);
  if (cosine <= 0) return 0;
  return choice_.probability(light) * light_point_pdf((*lights_)[light], hit) *
         direction_pdf(hit.position, hit.normal, w) / cosine;
}

float LightAim::density_from_infinity(std::uint32_t light, const Point3& position, const Vec3& wi, float pdf) const {
  return can_send_ ? choice_.probability(light) * pdf * disk_pdf(position, wi) : 0.0f;
}

}  // namespace etendue
