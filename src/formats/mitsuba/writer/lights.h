#pragma once

#include "formats/mitsuba/writer/shapes.h"

namespace etendue::mitsuba {

/// Adds a light: an <emitter>, or a <shape> that shines.
void add_light(pugi::xml_node parent, const scene::Light& light, WriterContext& context, TextureWriter& textures,
               ShapeWriter& shapes);

/// Whether light comes from infinitely far away in all directions: Mitsuba takes one such light only.
bool surrounds(const scene::Light& light);

}  // namespace etendue::mitsuba
