#pragma once

#include "render/scene_data.h"

namespace etendue {

/// Where a path met a surface.
struct Vertex {
  Vertex() = default;
  /// What `ray` finds at `hit`.
  Vertex(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit);

  Vec3 wo;  ///< unit, world: where the ray came from
  SurfaceHit surface;
  Scattering scattering;
  Spectrum emission = {};       ///< towards wo; black from behind
  std::uint32_t light = kNone;  ///< which the surface is, if it emits towards wo
  LightHit light_hit = {};      ///< where on the light
};

/// The vertex as lights see it when it is seen from `viewer` (unit): opaque surfaces are lit from that side alone.
Receiver receiver(const Vertex& vertex, const Vec3& viewer);
inline Receiver receiver(const Vertex& vertex) {
  return receiver(vertex, vertex.wo);
}

/// Share of the light that passes straight through the surface at `hit` (masks, null boundaries, thin glass); 0 for all
/// others.
Spectrum pass_through(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit);

/// The rest of `ray` behind what it met.
Ray straight_on(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit);

/// A ray and what it meets.
struct Meeting {
  Ray ray;
  RayHit hit;
  int rays = 0;  ///< that were traced to find it
};
/// What `ray` would meet at or behind `hit` if no shape shone.
Meeting behind_lights(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit);

}  // namespace etendue
