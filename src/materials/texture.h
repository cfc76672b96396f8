#pragma once

#include <variant>
#include <vector>

#include "image/image.h"
#include "math/vec.h"

namespace etendue {

/// Bilinear lookup between texel centres with repeat wrapping; v = 0 is the bottom row.
Spectrum lookup_texture(const Image& image, Vec2 uv);

/// The pictures of a scene; materials refer to them by index.
using Textures = std::vector<Image>;

/// A colour: constant or from the texture with the given index.
using ColorSource = std::variant<Spectrum, std::uint32_t>;

inline Spectrum evaluate_color(const ColorSource& source, const Textures& textures, Vec2 uv) {
  if (const Spectrum* constant = std::get_if<Spectrum>(&source)) return *constant;
  return lookup_texture(textures[std::get<std::uint32_t>(source)], uv);
}

}  // namespace etendue
