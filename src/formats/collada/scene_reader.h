#pragma once

#include "formats/collada/document.h"
#include "formats/report.h"
#include "scene/scene.h"

namespace etendue::collada {

/// The visual scene that the document instances, with everything it uses, in the world of SceneDescription.
/// What is wrong is reported; the scene then lacks it.
scene::SceneDescription read_scene(const Document& document, Report& report);

}  // namespace etendue::collada
