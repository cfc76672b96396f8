#pragma once

#include <vector>

#include "lights/emission.h"
#include "render/scene_data.h"

namespace etendue {

/// A few balls that hold all surfaces of specular materials; none if there are no such surfaces.
std::vector<AimTarget> specular_targets(const RenderScene::Data& scene);

}  // namespace etendue
