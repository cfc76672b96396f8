#pragma once

#include <optional>
#include <vector>

#include "geometry/geometry.h"
#include "lights/area_sampler.h"
#include "lights/light.h"
#include "lights/light_chooser.h"
#include "materials/material.h"
#include "media/medium.h"
#include "render/render_scene.h"

namespace etendue {

/// What integrators read of a compiled scene.
struct RenderScene::Data {
  /// What belongs to a shape of the geometry.
  struct ShapeInfo {
    std::uint32_t material = 0;
    std::uint32_t light = kNone;  ///< index of the light that this surface is
    bool in_group = false;
    bool separates_media = false;                      ///< behind it lies `interior`, before it `exterior`
    std::uint32_t interior = kNone, exterior = kNone;  ///< indices of media; kNone: vacuum
  };

  Geometry geometry;
  std::vector<ShapeInfo> shapes;
  /// Of each of the description's instances; kNone: it was left out, or is a group.
  std::vector<std::uint32_t> first_shape_of_instance;
  Materials materials;
  Textures textures;
  std::vector<Medium> media;
  std::uint32_t camera_medium = kNone;  ///< in which the description's camera stands
  std::vector<Light> lights;
  std::vector<std::uint32_t> infinite_lights;  ///< indices of the lights that rays into the void see
  bool may_pass = false;                       ///< some surface lets light through as if it were not there
  LightChooser light_choice;                   ///< made for these lights
  std::optional<AreaSampler> measured;         ///< the surface whose irradiance the camera measures
  double build_seconds = 0;
};

}  // namespace etendue
