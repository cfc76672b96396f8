#pragma once

#include "render/scene_data.h"

namespace etendue {

/// Where a path met a surface.
struct Vertex {
  SurfaceHit surface;
  Vec3 wo;  ///< unit, world: where the ray came from
  Scattering scattering;
  Spectrum emission = {};       ///< towards wo; black from behind
  std::uint32_t light = kNone;  ///< which the surface is, if it emits towards wo
  LightHit light_hit = {};      ///< where on the light
};

/// What `ray` finds at `hit`.
Vertex find_vertex(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit);

/// Share of the light that passes through the surface at `hit` as if it were not there (masks, null boundaries); 0 for
/// all others.
float pass_through(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit);

/// The rest of `ray` behind what it met.
Ray straight_on(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit);

}  // namespace etendue
