#pragma once

#include "formats/mitsuba/writer/media.h"

namespace etendue::mitsuba {

/// Adds a <sensor> with its film, its filter and the number of samples that the scene asks for.
void add_camera(pugi::xml_node parent, const scene::Camera& camera, WriterContext& context, MediumWriter& media);

}  // namespace etendue::mitsuba
