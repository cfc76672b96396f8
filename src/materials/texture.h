#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "geometry/geometry.h"
#include "image/texels.h"
#include "math/vec.h"
#include "volumes/volume.h"

namespace etendue {

/// Where on a surface textures are looked up.
struct TexturePoint {
  Vec2 uv;
  Point3 position;                     ///< world
  const Geometry* geometry = nullptr;  ///< for a mesh's attributes
  RayHit hit;
};

/// A colour: constant or from the texture with the given index.
using ColorSource = std::variant<Spectrum, std::uint32_t>;
/// A number: constant or the luminance of the texture with the given index.
using FloatSource = std::variant<float, std::uint32_t>;

/// Affine map of texture coordinates.
struct UvMap {
  Vec2 x{1, 0}, y{0, 1}, offset{0, 0};
  Vec2 operator()(Vec2 uv) const { return x * uv.x + y * uv.y + offset; }
};

enum class TexelFilter { nearest, bilinear };
enum class TexelWrap { repeat, mirror, clamp };

/// A picture; v = 0 is the lower edge of its bottom row.
struct BitmapTexture {
  Texels texels;
  TexelFilter filter = TexelFilter::bilinear;
  TexelWrap wrap = TexelWrap::repeat;
  UvMap to_uv = {};

  Spectrum lookup(Vec2 uv) const;
  /// ∂/∂u and ∂/∂v of the luminance of the bilinear lookup.
  Vec2 luminance_gradient(Vec2 uv) const;
};

/// color0 where both coordinates lie in the same half of their unit interval, else color1.
struct CheckerboardTexture {
  ColorSource color0, color1;
  UvMap to_uv = {};
};

/// A mesh's own attribute; black where it has none.
struct AttributeTexture {
  std::uint32_t attribute = 0;  ///< Geometry::attribute_name's number
  float scale = 1;
};

struct VolumeTexture {
  Volume volume;
};

using Texture = std::variant<BitmapTexture, CheckerboardTexture, AttributeTexture, VolumeTexture>;

/// The textures of a scene; materials and lights refer to them by index.
using Textures = std::vector<Texture>;

Spectrum evaluate_texture(const Textures& textures, std::uint32_t index, const TexturePoint& point);

/// ∂/∂u and ∂/∂v of the texture's luminance at a point; zero for textures without a gradient (all but bilinear
/// bitmaps).
Vec2 luminance_gradient(const Textures& textures, std::uint32_t index, const TexturePoint& point);

inline Spectrum evaluate_color(const ColorSource& source, const Textures& textures, const TexturePoint& point) {
  if (const Spectrum* constant = std::get_if<Spectrum>(&source)) return *constant;
  return evaluate_texture(textures, std::get<std::uint32_t>(source), point);
}

inline float evaluate_float(const FloatSource& source, const Textures& textures, const TexturePoint& point) {
  if (const float* constant = std::get_if<float>(&source)) return *constant;
  return evaluate_texture(textures, std::get<std::uint32_t>(source), point).luminance();
}

}  // namespace etendue
