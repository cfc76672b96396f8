#pragma once

#include "render/scene_data.h"
#include "scene/scene.h"

namespace etendue {

/// Puts the description's instances into data.geometry and data.shapes. What cannot be traced (no extent, beyond 1e12
/// m) is left out and counted. data.materials are there already.
void compile_shapes(const scene::SceneDescription& scene, RenderScene::Data& data, Diagnostics& diagnostics);

/// How far from the origin geometry may lie, in metres: beyond, the squares of distances between things would overflow.
inline constexpr float kReach = 1e12f;
inline bool is_out_of_reach(const Point3& p) {
  return !(max_abs_component(p) <= kReach);
}

}  // namespace etendue
