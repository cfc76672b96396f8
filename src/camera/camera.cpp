#include "camera/camera.h"

#include "sampling/warp.h"

namespace etendue {

Vec2 sample_aperture(const Camera& camera, Vec2 u) {
  if (camera.blades < 3) return sample_disk_concentric(u) * camera.lens_radius;
  // A triangle of the polygon's fan, then a point on it; u.x is stretched so that it serves both choices.
  const auto blades = static_cast<float>(camera.blades);
  const float blade = std::floor(u.x * blades);
  const Vec2 b = sample_triangle_uniform({u.x * blades - blade, u.y});
  const auto corner = [&](float i) {
    const float angle = camera.blade_rotation + 2 * kPi * i / blades;
    return Vec2(std::cos(angle), std::sin(angle)) * camera.lens_radius;
  };
  return corner(blade) * b.x + corner(blade + 1) * b.y;
}

namespace {

/// A ray along the axis through a point of the camera's plane.
Ray parallel_ray(const Camera& camera, float x, float y) {
  Ray ray{camera.to_world.point({x, y, 0}), -camera.to_world.z};
  ray.t_min = camera.near_clip;
  if (camera.far_clip > 0) ray.t_max = camera.far_clip;
  return ray;
}

}  // namespace

Ray generate_ray(const Camera& camera, Vec2 film, Vec2 lens) {
  const Transform& m = camera.to_world;
  const Vec2 centred = film + camera.principal_point;
  const Vec3 local((2 * centred.x - 1) * camera.tan_half_x, (1 - 2 * centred.y) * camera.tan_half_y, -1);
  if (camera.projection == Projection::orthographic) return parallel_ray(camera, local.x, local.y);
  if (camera.projection == Projection::radiance) return parallel_ray(camera, 0, 0);
  Vec3 direction = local;
  Point3 origin = m.origin;
  if (camera.lens_radius > 0) {
    const Vec2 l = sample_aperture(camera, lens);
    const Vec3 from(l.x, l.y, 0);
    direction = local * camera.focal_distance - from;  // towards the point that is sharp
    origin = m.point(from);
  }
  // −z after this division is the cosine to the axis: clipping planes are at distances along the axis.
  const float inv_length = 1 / length(direction);
  const float cosine = -direction.z * inv_length;
  Ray ray{origin, m.vector(direction * inv_length)};
  ray.t_min = camera.near_clip / cosine;
  if (camera.far_clip > 0) ray.t_max = camera.far_clip / cosine;
  return ray;
}

FilmPoint project(const Camera& camera, const Point3& world) {
  const Vec3 d = world - camera.to_world.origin;
  const float distance = -dot(d, camera.to_world.z);
  const float scale = camera.projection == Projection::perspective ? distance : 1.0f;
  const float x = dot(d, camera.to_world.x) / (scale * camera.tan_half_x);
  const float y = dot(d, camera.to_world.y) / (scale * camera.tan_half_y);
  return {Vec2(0.5f * (x + 1), 0.5f * (1 - y)) - camera.principal_point, distance};
}

}  // namespace etendue
