#pragma once

#include <optional>
#include <pugixml.hpp>

#include "formats/collada/document.h"
#include "formats/report.h"
#include "scene/scene.h"

namespace etendue::collada {

/// What a <light> shines like: as its CGL technique says (area, ambient, directional, point or spot), else its
/// technique_common. Nothing if it is black. Throws Problem if it is malformed.
std::optional<scene::LightSource> read_light(const Document& document, Report& report, pugi::xml_node light);

/// A <camera>, not yet placed: clip distances are in its own units. Throws Problem if it is malformed.
scene::Camera read_camera(const Document& document, Report& report, pugi::xml_node camera);

}  // namespace etendue::collada
