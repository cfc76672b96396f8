#pragma once

#include "materials/bsdf.h"
#include "materials/texture.h"

namespace etendue {

/// Lambertian with a colour or texture.
struct DiffuseMaterial {
  ColorSource reflectance;
};

/// A material whose BSDF is the same everywhere.
struct UniformMaterial {
  Bsdf bsdf;
};

/// What a surface is made of, compiled: yields the BSDF at a point.
struct Material {
  std::variant<UniformMaterial, DiffuseMaterial> surface;
  Spectrum emission;  ///< radiance leaving the front

  bool needs_texture_coordinates() const { return std::holds_alternative<DiffuseMaterial>(surface); }
};

/// The BSDF of `material` at texture coordinates `uv` (looked at only if needs_texture_coordinates).
Bsdf evaluate_material(const Material& material, Vec2 uv, const Textures& textures);

}  // namespace etendue
