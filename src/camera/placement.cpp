#include "camera/placement.h"

#include <fmt/format.h>

#include <optional>

namespace etendue {
namespace {

constexpr float kFitWidth = 800, kFitHeight = 600;  // the picture whose pixel size `fit` keeps
constexpr float kFitDistance = 1.5f;                // in diagonals of the scene's box
constexpr float kTolerance = 1e-3f;                 // of an axis' length and of the cosine between two axes
constexpr float kStandardXfovDeg = 50;

/// Half the picture's extent on the plane at distance 1.
struct HalfExtent {
  float x, y;
};

/// The smallest extent of this aspect (width / height) that holds `extent`.
HalfExtent grown_to_aspect(HalfExtent extent, float aspect) {
  const float x = std::max(extent.x, extent.y * aspect);
  return {x, x / aspect};
}

HalfExtent half_extent(float xfov_deg, float aspect) {
  const float x = std::tan(radians(xfov_deg) / 2);
  return {x, x / aspect};
}

HalfExtent file_extent(const scene::Camera& camera, Diagnostics& diagnostics) {
  if (camera.projection == scene::Projection::orthographic && camera.aspect > 0)
    return {length(camera.to_world.x), length(camera.to_world.y) / camera.aspect};
  const bool possible =
      camera.xfov_deg > 0 && camera.xfov_deg < 180 && camera.aspect > 0 && std::isfinite(camera.aspect);
  if (possible) return half_extent(camera.xfov_deg, camera.aspect);
  diagnostics.warning(fmt::format("the camera \"{}\" has an impossible field of view ({} degrees, aspect ratio {}); "
                                  "{} degrees at 4:3 are used",
                                  camera.name, camera.xfov_deg, camera.aspect, kStandardXfovDeg),
                      camera.where);
  return half_extent(kStandardXfovDeg, kFitWidth / kFitHeight);
}

/// The camera's frame with orthonormal, right-handed axes: direction of view first, then up. Nothing if the matrix is
/// singular.
std::optional<Transform> repaired_frame(const scene::Camera& camera, Diagnostics& diagnostics) {
  const Transform& m = camera.to_world;
  const Vec3 back = normalize(m.z);
  const Vec3 up = normalize(m.y - back * dot(m.y, back));
  const Transform frame{cross(up, back), up, back, m.origin};
  if (!is_finite(frame.x) || !is_finite(frame.origin) || length(frame.x) < 0.5f) return std::nullopt;

  const bool mirrored = m.determinant() < 0;
  const float right_sign = mirrored ? -1.0f : 1.0f;
  const float deviation = std::max({length(m.x * right_sign - frame.x), length(m.y - frame.y), length(m.z - frame.z)});
  if (mirrored)
    diagnostics.warning(fmt::format("the camera \"{}\" is mirrored by its transforms; it was turned right-handed, so "
                                    "that the picture is not mirrored",
                                    camera.name),
                        camera.where);
  else if (deviation > kTolerance && camera.projection != scene::Projection::orthographic)
    diagnostics.warning(fmt::format("the camera \"{}\" is scaled or skewed by its transforms; its axes were made "
                                    "orthonormal, its field of view stays",
                                    camera.name),
                        camera.where);
  return frame;
}

/// World y, or what the teaching renderer's spherical coordinates make of it where the camera looks straight up or
/// down.
Vec3 up_for(const Vec3& towards_camera) {
  const bool at_pole = std::hypot(towards_camera.x, towards_camera.z) < 1e-6f;
  return at_pole ? Vec3(0, 0, -std::copysign(1.0f, towards_camera.y)) : Vec3(0, 1, 0);
}

/// Looks at the box' centre from `distance` away; `towards_camera` is unit.
Transform aimed_at(const Bounds3& bounds, const Vec3& towards_camera, float distance) {
  const Point3 center = bounds.center();
  return Transform::look_at(center + towards_camera * distance, center, up_for(towards_camera));
}

/// Distance along the axis to the box' farthest corner.
float depth_of_far_corner(const Transform& frame, const Bounds3& bounds) {
  float depth = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Point3 p((corner & 1) ? bounds.max.x : bounds.min.x, (corner & 2) ? bounds.max.y : bounds.min.y,
                   (corner & 4) ? bounds.max.z : bounds.min.z);
    depth = std::max(depth, dot(frame.origin - p, frame.z));
  }
  return depth;
}

/// The whole box from the front, slightly above.
Camera framing_camera(const Bounds3& bounds, float aspect) {
  const HalfExtent extent = grown_to_aspect(half_extent(kStandardXfovDeg, kFitWidth / kFitHeight), aspect);
  const float radius = bounds.diagonal() > 0 ? bounds.diagonal() / 2 : 1;
  const float half_angle = std::atan(std::min(extent.x, extent.y));
  Camera camera;
  camera.to_world = aimed_at(bounds, normalize(Vec3(0, 0.25f, 1)), radius / std::sin(half_angle));
  camera.tan_half_x = extent.x;
  camera.tan_half_y = extent.y;
  camera.focal_distance = length(camera.to_world.origin - bounds.center());
  return camera;
}

Projection projection_of(const scene::Camera& camera) {
  switch (camera.projection) {
    case scene::Projection::perspective:
      return Projection::perspective;
    case scene::Projection::orthographic:
      return Projection::orthographic;
    case scene::Projection::radiance:
      return Projection::radiance;
    case scene::Projection::irradiance:
      return Projection::irradiance;
  }
  return Projection::perspective;
}

Camera file_camera(const scene::Camera& from, const Transform& frame, HalfExtent extent, float aspect) {
  const HalfExtent grown = grown_to_aspect(extent, aspect);
  Camera camera;
  camera.to_world = frame;
  camera.projection = projection_of(from);
  camera.tan_half_x = from.mirrored ? -grown.x : grown.x;
  camera.tan_half_y = grown.y;
  camera.principal_point = {from.principal_point[0], from.principal_point[1]};
  camera.lens_radius = from.lens_radius;
  if (from.focal_distance > 0) camera.focal_distance = from.focal_distance;
  camera.near_clip = from.near_clip;
  camera.far_clip = from.far_clip;
  return camera;
}

/// Which way the camera stands as seen from what it looks at, in `fit`: M·(0,0,−1), normalised.
Vec3 fit_direction(const scene::Camera& from, Diagnostics& diagnostics) {
  const Vec3 direction = normalize(from.to_world.point({0, 0, -1}));
  if (is_finite(direction)) return direction;
  diagnostics.warning(
      fmt::format("the camera \"{}\" names no direction (its matrix maps (0, 0, -1) to the origin); the "
                  "scene is seen from the front",
                  from.name),
      from.where);
  return {0, 0, 1};
}

Camera fit_camera(const scene::Camera& from, const Bounds3& bounds, HalfExtent extent, int width, int height,
                  Diagnostics& diagnostics) {
  const float diagonal = bounds.diagonal() > 0 ? bounds.diagonal() : 1;
  const HalfExtent grown = grown_to_aspect(extent, kFitWidth / kFitHeight);
  Camera camera;
  camera.to_world = aimed_at(bounds, fit_direction(from, diagnostics), kFitDistance * diagonal);
  camera.tan_half_x = grown.x * static_cast<float>(width) / kFitWidth;
  camera.tan_half_y = grown.y * static_cast<float>(height) / kFitHeight;
  camera.near_clip = from.near_clip;
  camera.far_clip = from.far_clip;
  camera.focal_distance = kFitDistance * diagonal;

  if (static_cast<float>(width) < kFitWidth && static_cast<float>(height) < kFitHeight)
    diagnostics.info(
        fmt::format("the fit camera shows the middle {} x {} of its {} x {} view, as the course's renderer does; "
                    "--camera-placement file shows all of the file's own",
                    width, height, kFitWidth, kFitHeight));

  const float needed = depth_of_far_corner(camera.to_world, bounds);
  if (camera.far_clip > 0 && camera.far_clip < needed)
    diagnostics.warning(
        fmt::format("the camera \"{}\" sees nothing beyond {:.4g}, but the scene reaches to {:.4g}; raise "
                    "its far distance, or take the file's own camera with --camera-placement file",
                    from.name, camera.far_clip, needed),
        from.where);
  return camera;
}

}  // namespace

Camera place_camera(const scene::SceneDescription& scene, const Bounds3& bounds, CameraPlacement placement, int width,
                    int height, Diagnostics& diagnostics) {
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  if (scene.cameras.empty()) {
    diagnostics.info("the scene has no camera; it is framed from the front");
    return framing_camera(bounds, aspect);
  }

  const scene::Camera& from = scene.cameras.front();
  const bool fit =
      placement == CameraPlacement::fit || (placement == CameraPlacement::automatic && scene.uses_cgl_profile);
  if (fit) return fit_camera(from, bounds, file_extent(from, diagnostics), width, height, diagnostics);

  const std::optional<Transform> frame = repaired_frame(from, diagnostics);
  if (!frame) {
    diagnostics.warning(
        fmt::format("the camera \"{}\" has a singular matrix; the scene is framed from the front instead", from.name),
        from.where);
    return framing_camera(bounds, aspect);
  }
  return file_camera(from, *frame, file_extent(from, diagnostics), aspect);
}

}  // namespace etendue
