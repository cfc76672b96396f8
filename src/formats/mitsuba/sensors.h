#pragma once

#include <optional>

#include "formats/mitsuba/media.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// A <sensor> with its film, and how many samples its sampler asks for.
struct Sensor {
  scene::Camera camera;
  std::optional<int> samples_per_pixel;
};

/// Reads a <sensor>; nothing, with a warning, if it is not known. Throws Problem.
std::optional<Sensor> read_sensor(const Document& document, const Element& element, MediumLibrary& media,
                                  Report& report);

}  // namespace etendue::mitsuba
