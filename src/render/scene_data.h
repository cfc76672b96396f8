#pragma once

#include <vector>

#include "geometry/geometry.h"
#include "lights/light.h"
#include "materials/material.h"
#include "render/render_scene.h"
#include "sampling/distribution.h"

namespace etendue {

/// What integrators read of a compiled scene.
struct RenderScene::Data {
  /// What belongs to a shape of the geometry.
  struct ShapeInfo {
    std::uint32_t material = 0;
    std::uint32_t light = kNone;  ///< index of the light that this surface is
  };

  Geometry geometry;
  std::vector<ShapeInfo> shapes;
  std::vector<Material> materials;
  Textures textures;
  std::vector<Light> lights;
  std::vector<std::uint32_t> infinite_lights;  ///< indices of the lights that rays into the void see
  DiscreteDistribution light_choice;           ///< by power; empty without lights
  double build_seconds = 0;
};

}  // namespace etendue
