#pragma once

#include "camera/camera.h"
#include "render/scene_data.h"
#include "render/settings.h"

namespace etendue {

/// Width in metres of a pixel at the first surfaces with more than delta lobes that the camera sees, whichever way it
/// sees them: a width that three quarters of them exceed. 0 if there are none, or for cameras that see no scene.
float usual_pixel_width(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings);

}  // namespace etendue
