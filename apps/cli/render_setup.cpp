#include "render_setup.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/log.h"
#include "camera/settings_file.h"
#include "formats/formats.h"
#include "render_options.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;

/// Where the camera stands, before its lens.
Camera placed_camera(const RenderOptions& options, const scene::SceneDescription& description, const Bounds3& bounds,
                     Diagnostics& diagnostics) {
  const auto& [width, height] = std::pair(options.settings.width, options.settings.height);
  if (options.camera_file) return read_camera_settings(*options.camera_file, width, height);
  return place_camera(description, bounds, options.placement, width, height, diagnostics);
}

/// A light at the camera under which white surfaces at the distance of the scene's centre look white.
scene::Light headlight(const Camera& camera, const Bounds3& bounds) {
  const float distance = std::max(length(bounds.center() - camera.to_world.origin), bounds.diagonal() / 2);
  const Spectrum intensity(kPi * distance * distance);
  return {"headlight", scene::PointLight{intensity}, Transform::translation(camera.to_world.origin), {}};
}

}  // namespace

scene::SceneDescription read_description(const RenderOptions& options, Diagnostics& diagnostics) {
  scene::SceneDescription description = read_scene(options.scene, diagnostics, options.read);
  if (options.environment) {
    std::error_code failure;
    if (!fs::exists(options.environment->file, failure))
      throw Error(Failure::input, fmt::format("there is no environment map {}", options.environment->file.string()));
    description.lights.push_back({"environment", *options.environment, {}, {}});
  }
  return description;
}

RenderOptions with_file_settings(RenderOptions options, const scene::SceneDescription& description) {
  RenderSettings& s = options.settings;
  const RenderOptions::Given& given = options.given;
  const scene::RenderHints& hints = description.hints;
  const bool uses_file_camera = options.placement != CameraPlacement::fit && !options.camera_file;
  if (uses_file_camera && !description.cameras.empty()) {
    const scene::Film& film = description.cameras.front().film;
    if (film.width > 0 && film.height > 0 && !given.size) {
      s.width = film.width;
      s.height = film.height;
      if (film.crop && !given.crop) {
        const auto& [x, y, width, height] = *film.crop;
        s.crop = CropWindow{x, y, width, height};
      }
    }
    if (film.filter && !given.filter) s.filter = *film.filter;
  }
  if (hints.samples_per_pixel && !given.samples)
    s.samples_per_pixel = std::clamp(*hints.samples_per_pixel, 1, kMostSamplesPerPixel);
  if (hints.max_depth && !given.depth) s.max_depth = *hints.max_depth;
  s.null_counts_as_bounce = hints.null_counts_as_bounce;
  s.hide_emitters = hints.hide_emitters;
  check_picture(options);
  return options;
}

PreparedScene prepare_scene(const RenderOptions& options, const scene::SceneDescription& description,
                            Diagnostics& diagnostics) {
  CompileOptions compile_options = options.compile;
  if (options.headlight)
    compile_options.light_for = [&](const Bounds3& bounds) {
      Diagnostics told_below;
      return headlight(placed_camera(options, description, bounds, told_below), bounds);
    };
  RenderScene scene = compile(description, compile_options, diagnostics);
  Camera camera = placed_camera(options, description, scene.bounds(), diagnostics);
  return {std::move(scene), camera};
}

Camera with_lens(Camera camera, const RenderOptions& options, const RenderScene& scene) {
  camera.lens_radius = options.lens_radius.value_or(camera.lens_radius);
  camera.blades = options.blades;
  camera.blade_rotation = radians(options.blade_rotation_deg);
  if (options.focal_distance) {
    camera.focal_distance = *options.focal_distance;
  } else if (options.focus_at) {
    const auto [x, y] = *options.focus_at;
    const auto depth = scene.depth_at(camera, x, y, options.settings.width, options.settings.height);
    if (!depth)
      throw Error(
          Failure::usage,
          fmt::format("--focus-at {},{} shows no surface; choose a pixel that does, or give --focal-distance", x, y));
    camera.focal_distance = *depth;
    log_info(fmt::format("focus: {:.4g}, what pixel {},{} shows", *depth, x, y));
  } else if (camera.lens_radius > 0 && (options.lens_radius || camera.focal_distance <= 0) && !options.camera_file) {
    const float depth = project(camera, scene.bounds().center()).distance;
    if (depth <= 0)
      throw Error(Failure::usage,
                  "the scene's centre is behind the camera: a lens needs --focal-distance or --focus-at");
    camera.focal_distance = depth;
    log_info(fmt::format("focus: {:.4g}, the scene's centre (--focal-distance or --focus-at choose another)", depth));
  }
  if (camera.lens_radius == 0 && (options.focal_distance || options.focus_at || options.blades > 0))
    log_warning("warning: a pinhole has everything in focus; give --lens-radius as well");
  return camera;
}

Point3 turning_point(const Camera& camera, const Bounds3& bounds) {
  const float distance = std::max(project(camera, bounds.center()).distance, 0.01f * bounds.diagonal());
  return camera.to_world.origin - camera.to_world.z * distance;
}

}  // namespace etendue
