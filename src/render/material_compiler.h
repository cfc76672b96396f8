#pragma once

#include "materials/material.h"
#include "materials/texture.h"
#include "render/render_scene.h"

namespace etendue {

/// Reads the description's textures, index by index. What cannot be read becomes grey with a warning; texels that no
/// texture can have are repaired and counted. `geometry` gives attributes their numbers.
Textures compile_textures(const scene::SceneDescription& scene, Geometry& geometry, Diagnostics& diagnostics);

/// The description's materials, index by index. Those that would contain themselves become grey with a warning.
Materials compile_materials(const scene::SceneDescription& scene, const CompileOptions& options,
                            Diagnostics& diagnostics);

ColorSource compile_input(const scene::ColorInput& input);
FloatSource compile_input(const scene::FloatInput& input);

}  // namespace etendue
