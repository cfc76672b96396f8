#include "render/vertex.h"

namespace etendue {
namespace {

MaterialPoint material_point(const RenderScene::Data& scene, const Material& material, const SurfaceHit& surface,
                             const RayHit& hit) {
  MaterialPoint point;
  point.surface = surface;
  if (material.needs_tangents) {
    point.parametrization = scene.geometry.parametrization(hit, surface);
    point.texture = {point.parametrization.uv, surface.position, &scene.geometry, hit};
  } else if (material.needs_texture_point) {
    point.texture = {scene.geometry.texture_coordinates(hit, surface), surface.position, &scene.geometry, hit};
  }
  return point;
}

Scattering scatter(const RenderScene::Data& scene, const SurfaceHit& surface, const RayHit& hit, const Vec3& wo) {
  const std::uint32_t material = scene.shapes[hit.shape].material;
  return scatter(scene.materials, material, scene.textures,
                 material_point(scene, scene.materials[material], surface, hit), wo);
}

}  // namespace

Receiver receiver(const Vertex& vertex, const Vec3& viewer) {
  if (vertex.scattering.transmits()) return {vertex.surface.position};
  const Vec3& n = vertex.surface.geometric_normal;
  const Gloss gloss = vertex.scattering.gloss();
  return {vertex.surface.position, dot(n, viewer) < 0 ? -n : n, viewer, gloss.share, square(gloss.width)};
}

Vertex::Vertex(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit)
    : wo(-ray.direction), surface(scene.geometry.surface(ray, hit)), scattering(scatter(scene, surface, hit, wo)) {
  const RenderScene::Data::ShapeInfo& shape = scene.shapes[hit.shape];
  if (shape.light == kNone || dot(wo, surface.geometric_normal) <= 0) return;
  const Material& material = scene.materials[shape.material];
  emission = evaluate_color(material.emission, scene.textures, material_point(scene, material, surface, hit).texture);
  light = shape.light;
  light_hit = {surface.position, surface.geometric_normal, hit.primitive, hit.u, hit.v};
}

Spectrum pass_through(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit) {
  if (!scene.materials[scene.shapes[hit.shape].material].may_pass) return Spectrum(0);
  return scatter(scene, scene.geometry.surface(ray, hit), hit, -ray.direction).straight_through();
}

Ray straight_on(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit) {
  const SurfaceHit surface = scene.geometry.surface(ray, hit);
  Ray rest{offset_origin(surface, ray.direction), ray.direction};
  rest.t_max = ray.t_max - dot(rest.origin - ray.origin, ray.direction);  // the same end
  return rest;
}

Meeting behind_lights(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit) {
  Meeting meeting{ray, hit};
  while (meeting.hit.found() && scene.shapes[meeting.hit.shape].light != kNone) {
    meeting.ray = straight_on(scene, meeting.ray, meeting.hit);
    meeting.hit = scene.geometry.intersect(meeting.ray);
    ++meeting.rays;
  }
  return meeting;
}

}  // namespace etendue
