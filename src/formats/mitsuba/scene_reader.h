#pragma once

#include "formats/mitsuba/document.h"
#include "formats/report.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// Everything that the scene shows, as a SceneDescription. What is wrong is reported; the scene then lacks it.
/// Materials, textures and media that nothing uses are not read.
scene::SceneDescription read_scene(const Document& document, Report& report);

}  // namespace etendue::mitsuba
