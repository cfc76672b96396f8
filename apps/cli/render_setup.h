#pragma once

#include "camera/camera.h"
#include "options.h"
#include "render/render_scene.h"

namespace etendue {

/// The scene file with the environment map that was asked for. Throws Error(Failure::input).
scene::SceneDescription read_description(const RenderOptions& options, Diagnostics& diagnostics);

/// The options with what the file asks of its picture, where they left that open. Throws Error(Failure::usage) if such
/// a picture cannot be made.
RenderOptions with_file_settings(RenderOptions options, const scene::SceneDescription& description);

/// A compiled scene and where its picture is taken from.
struct PreparedScene {
  RenderScene scene;
  Camera camera;  ///< without the lens that was asked for
};

/// Compiles the description, with the headlight if one was asked for.
PreparedScene prepare_scene(const RenderOptions& options, const scene::SceneDescription& description,
                            Diagnostics& diagnostics);

/// The camera with the aperture and the focus that were asked for. Throws Error(Failure::usage) if there is nothing to
/// focus on.
Camera with_lens(Camera camera, const RenderOptions& options, const RenderScene& scene);

/// The point on the camera's axis beside the scene's centre: what the camera turns about.
Point3 turning_point(const Camera& camera, const Bounds3& bounds);

}  // namespace etendue
