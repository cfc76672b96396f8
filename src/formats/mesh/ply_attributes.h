#pragma once

#include <string>
#include <vector>

#include "formats/mesh/ply_header.h"

namespace etendue::ply {

/// Properties that together are an attribute of a mesh.
struct Attribute {
  std::string name;                     ///< "vertex_color", "face_weight", …
  std::vector<std::size_t> properties;  ///< indices of its 1 or 3 channels in the element
};

/// The attributes that an element's properties make: red green blue or r g b are PREFIX + "color"; a run of NAME_0
/// NAME_1 NAME_2 (likewise _1 _2 _3 and _x _y _z), or its first alone, is PREFIX + NAME; a run of NAME_r NAME_g NAME_b
/// is PREFIX + NAME + "_color". Other properties are left out, and the first attribute of a name counts.
std::vector<Attribute> find_attributes(const Element& element, const std::string& prefix);

}  // namespace etendue::ply
