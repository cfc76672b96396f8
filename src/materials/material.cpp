#include "materials/material.h"

namespace etendue {

Bsdf evaluate_material(const Material& material, Vec2 uv, const Textures& textures) {
  if (const auto* uniform = std::get_if<UniformMaterial>(&material.surface)) return uniform->bsdf;
  return DiffuseBsdf{evaluate_color(std::get<DiffuseMaterial>(material.surface).reflectance, textures, uv)};
}

}  // namespace etendue
