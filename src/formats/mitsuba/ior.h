#pragma once

#include "formats/mitsuba/properties.h"

namespace etendue::mitsuba {

/// A property that is an index of refraction: a number, or the name of a material. Throws Problem if it is not above
/// zero or the name is not known.
float index_of_refraction(Properties& properties, std::string_view name, std::string_view missing);

}  // namespace etendue::mitsuba
