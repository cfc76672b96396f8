#pragma once

#include "render/scene_data.h"
#include "scene/scene.h"

namespace etendue {

/// Makes lights of the shapes that shine and of the description's own, and how to choose among them.
/// Rectangle lights add shapes; everything else of `data` is there already, the geometry not yet built.
void compile_lights(const scene::SceneDescription& scene, const CompileOptions& options, RenderScene::Data& data,
                    Diagnostics& diagnostics);

}  // namespace etendue
