#pragma once

#include <optional>

#include "formats/mitsuba/textures.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// An <emitter> that is not part of a surface; nothing, with a warning, if it is not known. Throws Problem.
std::optional<scene::Light> read_emitter(const Document& document, const Element& element, TextureLibrary& textures,
                                         Report& report);

/// The radiance of an <emitter type="area"> within a shape; nothing, with a warning, if it is of another type. Throws
/// Problem.
std::optional<scene::ColorInput> read_area_emitter(const Document& document, const Element& element,
                                                   TextureLibrary& textures, Report& report);

}  // namespace etendue::mitsuba
