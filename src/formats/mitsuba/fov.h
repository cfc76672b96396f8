#pragma once

#include "formats/mitsuba/properties.h"

namespace etendue::mitsuba {

/// The full horizontal angle, in degrees, that "fov" and "fov_axis" or "focal_length" (of a 36 × 24 mm film, by its
/// diagonal) give a picture of that width over height. Throws Problem if it is not between 0 and 180.
float read_horizontal_fov(Properties& properties, float aspect);

}  // namespace etendue::mitsuba
