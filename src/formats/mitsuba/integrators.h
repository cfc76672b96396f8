#pragma once

#include "formats/mitsuba/properties.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// What an <integrator> asks of a render.
struct Integrator {
  scene::RenderHints hints;
  bool sees_media = true;
};
/// Those that only wrap others ("moment", "aov") count for what they wrap. Of an unknown one only the depth is taken,
/// with a warning. Throws Problem.
Integrator read_integrator(const Document& document, const Element& element, Report& report);

}  // namespace etendue::mitsuba
