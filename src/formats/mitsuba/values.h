#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "formats/mitsuba/document.h"
#include "math/vec.h"

namespace etendue::mitsuba {

/// The words of an attribute, parted by commas and white space.
std::vector<std::string_view> words_of(std::string_view text);

/// A finite number. Throws Problem if `word`, a part of the attribute, is anything else.
float to_number(std::string_view word, const Attribute& attribute);

/// The numbers of an attribute. Throws Problem if one of its words is none.
std::vector<float> numbers_of(const Attribute& attribute);

/// The element's attribute; throws Problem if it has none of that name.
const Attribute& required(const Element& element, std::string_view name);

/// value="x y z", value="s" for three times s, or x="…" y="…" z="…" of which missing ones are `missing`. Throws Problem
/// otherwise.
Vec3 vector_of(const Element& element, float missing);

}  // namespace etendue::mitsuba
