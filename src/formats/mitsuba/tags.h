#pragma once

#include "formats/mitsuba/document.h"

namespace etendue::mitsuba {

/// Whether elements of that name describe something with properties of its own.
bool is_object_tag(std::string_view tag);

/// Throws Problem if a scene has no elements of this name, if it may not stand in <parent>, or if its attributes are
/// not those it may and must have. `parent` is empty for a file's root.
void check_element(const Element& element, std::string_view parent);

/// Mitsuba 0.6 wrote names like toWorld and lookAt: brings those of an element and its "name" to today's.
void upgrade_names(Element& element, std::string_view parent_type);

}  // namespace etendue::mitsuba
