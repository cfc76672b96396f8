#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <pugixml.hpp>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "formats/collada/document.h"
#include "math/vec.h"

namespace etendue::collada {

/// Vectors inside an array of floats, as an <accessor> describes them. Valid as long as the SourceLibrary.
class Accessor {
 public:
  Accessor() = default;
  /// Vector i takes components data[i · stride + slot[k]].
  Accessor(const float* data, std::size_t count, std::size_t stride, std::array<std::size_t, 3> slot)
      : data_(data), count_(count), stride_(stride), slot_(slot) {}

  std::size_t count() const { return count_; }
  Vec3 vec3(std::size_t i) const {
    const float* v = data_ + i * stride_;
    return {v[slot_[0]], v[slot_[1]], v[slot_[2]]};
  }
  Vec2 vec2(std::size_t i) const {
    const float* v = data_ + i * stride_;
    return {v[slot_[0]], v[slot_[1]]};
  }

 private:
  const float* data_ = nullptr;
  std::size_t count_ = 0, stride_ = 0;
  std::array<std::size_t, 3> slot_{};
};

/// Reads each <float_array> of a document once, however many sources and meshes share it.
class SourceLibrary {
 public:
  explicit SourceLibrary(const Document& document) : document_(document) {}

  /// The vectors of a <source>, of at least `components` (2 or 3) floats each. Throws Problem if it is malformed.
  Accessor read(pugi::xml_node source, std::size_t components);

 private:
  const std::vector<float>& floats(pugi::xml_node array);

  const Document& document_;
  std::unordered_map<const void*, std::vector<float>> arrays_;
};

}  // namespace etendue::collada
