#include "render/caustic_targets.h"

#include <algorithm>
#include <span>

namespace etendue {
namespace {

/// Balls are this much larger than what they hold, so that rounding finds a ray to their rim inside.
constexpr float kMargin = 1.001f;

AimTarget around(const Bounds3& bounds) {
  return {bounds.center(), 0.5f * bounds.diagonal()};
}

AimTarget around(const AimTarget& a, const AimTarget& b) {
  const Vec3 d = b.center - a.center;
  const float distance = length(d);
  if (distance + b.radius <= a.radius) return a;
  if (distance + a.radius <= b.radius) return b;
  const float radius = 0.5f * (distance + a.radius + b.radius);
  return {a.center + d * ((radius - a.radius) / distance), radius};
}

AimTarget around(std::span<const AimTarget> targets) {
  AimTarget all = targets.front();
  for (const AimTarget& target : targets.subspan(1)) all = around(all, target);
  return all;
}

/// Joins neighbours until at most `most` are left: halves along the longest side, each with its share of `most`.
void join(std::span<AimTarget> targets, std::size_t most, std::vector<AimTarget>& joined) {
  if (targets.size() <= most) {
    joined.insert(joined.end(), targets.begin(), targets.end());
    return;
  }
  if (most == 1) {
    joined.push_back(around(targets));
    return;
  }
  Bounds3 centers;
  for (const AimTarget& target : targets) centers.extend(target.center);
  const Vec3 size = centers.max - centers.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t half = targets.size() / 2;
  std::nth_element(targets.begin(), targets.begin() + static_cast<std::ptrdiff_t>(half), targets.end(),
                   [axis](const AimTarget& a, const AimTarget& b) { return a.center[axis] < b.center[axis]; });
  join(targets.first(half), most / 2, joined);
  join(targets.subspan(half), most - most / 2, joined);
}

}  // namespace

std::vector<AimTarget> specular_targets(const RenderScene::Data& scene) {
  std::vector<AimTarget> targets;
  bool in_groups = false;
  for (std::uint32_t shape = 0; shape < scene.shapes.size(); ++shape) {
    const Material& material = scene.materials[scene.shapes[shape].material];
    if (!material.specular && !(material.gleams && !scene.infinite_lights.empty())) continue;
    in_groups |= scene.shapes[shape].in_group;
    if (scene.geometry.kind(shape) == Geometry::Kind::sphere)
      targets.push_back({scene.geometry.sphere(shape).center, scene.geometry.sphere(shape).radius});
    else
      targets.push_back(around(scene.geometry.shape_bounds(shape)));
  }
  // Instances may be anywhere.
  if (in_groups) targets = {around(scene.geometry.bounds())};
  std::vector<AimTarget> joined;
  if (!targets.empty()) join(targets, LightAim::kMostTargets, joined);
  for (AimTarget& target : joined) target.radius *= kMargin;
  return joined;
}

}  // namespace etendue
