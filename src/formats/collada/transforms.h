#pragma once

#include <pugixml.hpp>

#include "formats/collada/document.h"
#include "formats/report.h"
#include "math/transform.h"

namespace etendue::collada {

/// The file's world to ours (y-up, metres), from <asset>: <unit meter="…"> scales, <up_axis> turns:
/// Z_UP maps (x, y, z) to (−x, z, y), X_UP maps it to (y, x, −z), both proper rotations.
Transform file_to_world(const Document& document, Report& report);

/// A node's own transform: its matrix, translate, rotate, scale, lookat and skew elements in document order, each
/// applied in the frame that those before it have made. Throws Problem if one is malformed.
Transform node_transform(const Document& document, Report& report, pugi::xml_node node);

}  // namespace etendue::collada
