#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/log.h"
#include "base/output_file.h"
#include "commands.h"
#include "file_names.h"
#include "formats/formats.h"
#include "interrupt.h"
#include "render_setup.h"
#include "scene_loading.h"

namespace etendue {
namespace {

scene::Projection projection_of(const Camera& camera) {
  switch (camera.projection) {
    case Projection::perspective:
      return scene::Projection::perspective;
    case Projection::orthographic:
      return scene::Projection::orthographic;
    case Projection::radiance:
      return scene::Projection::radiance;
    case Projection::irradiance:
      break;
  }
  return scene::Projection::irradiance;
}

/// A placed camera as a scene file describes it, for a picture as `settings` say.
scene::Camera described(const Camera& placed, const RenderSettings& settings) {
  scene::Camera camera;
  camera.name = "camera";
  camera.to_world = placed.to_world;
  camera.projection = projection_of(placed);
  camera.mirrored = placed.tan_half_x < 0;
  const float half_width = std::abs(placed.tan_half_x);
  if (placed.projection == Projection::orthographic)
    camera.to_world = camera.to_world * Transform::scaling(Vec3(half_width));
  camera.xfov_deg = static_cast<float>(2 * std::atan(static_cast<double>(half_width)) * 180 / std::numbers::pi);
  camera.aspect = half_width / placed.tan_half_y;
  camera.principal_point = {placed.principal_point.x, placed.principal_point.y};
  camera.near_clip = placed.near_clip;
  camera.far_clip = placed.far_clip;
  camera.lens_radius = placed.lens_radius;
  camera.focal_distance = placed.focal_distance;
  camera.film = {settings.width, settings.height, {}, settings.filter};
  if (settings.crop)
    camera.film.crop = {settings.crop->x, settings.crop->y, settings.crop->width, settings.crop->height};
  return camera;
}

/// Whether a render takes the file's camera and the size of its film as they are.
bool keeps_camera(const RenderOptions& options, const scene::SceneDescription& scene) {
  const bool fits = options.placement == CameraPlacement::fit ||
                    (options.placement == CameraPlacement::automatic && scene.uses_cgl_profile);
  return !fits && !options.given.size && !scene.cameras.empty() && scene.cameras.front().film.width > 0;
}

/// Puts the camera that a render would use, and its picture, first.
void place(scene::SceneDescription& scene, const RenderOptions& options, Diagnostics& diagnostics) {
  if (keeps_camera(options, scene)) return;
  const RenderOptions settled = with_file_settings(options, scene);
  const PreparedScene prepared = prepare_scene(settled, scene, diagnostics);
  scene::Camera camera = described(prepared.camera, settled.settings);
  if (scene.cameras.empty()) scene.cameras.emplace_back().name = camera.name;
  scene::Camera& first = scene.cameras.front();
  camera.name = first.name;
  camera.where = first.where;
  camera.medium = first.medium;
  camera.measured_shape = first.measured_shape;
  first = camera;
}

}  // namespace

int run(const ConvertOptions& options) {
  check_scene_writable(options.output);
  std::vector<std::filesystem::path> read = {options.render.scene};
  if (options.render.environment) read.push_back(options.render.environment->file);
  check_distinct(read, {options.output});
  check_file_writable(options.output);

  Diagnostics diagnostics;
  DiagnosticsPrinter printer(diagnostics);
  scene::SceneDescription scene = read_description(options.render, diagnostics);
  place(scene, options.render, diagnostics);
  catch_interrupts();
  const bool is_written = write_scene(options.output, scene, diagnostics, interrupted);
  printer.print();
  if (!is_written) {
    log_warning("interrupted; nothing was written");
    return kInterruptedExitCode;
  }
  log_info(fmt::format("wrote {}", options.output.string()));
  return 0;
}

}  // namespace etendue
