#pragma once

#include "render/scene_data.h"
#include "scene/scene.h"

namespace etendue {

/// The description's media, index by index. Values that no medium can have are brought to what is near and counted.
/// Throws Error(Failure::input) if a volume cannot be read.
std::vector<Medium> compile_media(const scene::SceneDescription& scene, Diagnostics& diagnostics);

}  // namespace etendue
