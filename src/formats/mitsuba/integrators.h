#pragma once

#include "formats/mitsuba/properties.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// What an <integrator> asks of a render; those that only wrap others ("moment", "aov") count for what they wrap. Of an
/// unknown one only the depth is taken, with a warning. Throws Problem.
scene::RenderHints read_integrator(const Document& document, const Element& element, Report& report);

}  // namespace etendue::mitsuba
