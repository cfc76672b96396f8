#include "render/vertex.h"

namespace etendue {
namespace {

MaterialPoint material_point(const RenderScene::Data& scene, const Material& material, const Ray& ray,
                             const RayHit& hit) {
  MaterialPoint point;
  point.surface = scene.geometry.surface(ray, hit);
  if (material.needs_tangents) {
    point.parametrization = scene.geometry.parametrization(hit, point.surface);
    point.texture = {point.parametrization.uv, point.surface.position, &scene.geometry, hit};
  } else if (material.needs_texture_point) {
    point.texture = {scene.geometry.texture_coordinates(hit, point.surface), point.surface.position, &scene.geometry,
                     hit};
  }
  return point;
}

}  // namespace

Receiver receiver(const Vertex& vertex) {
  if (vertex.scattering.transmits()) return {vertex.surface.position};
  const Vec3& n = vertex.surface.geometric_normal;
  const Gloss gloss = vertex.scattering.gloss();
  return {vertex.surface.position, dot(n, vertex.wo) < 0 ? -n : n, vertex.wo, gloss.share, square(gloss.width)};
}

Vertex find_vertex(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit) {
  const RenderScene::Data::ShapeInfo& shape = scene.shapes[hit.shape];
  const Material& material = scene.materials[shape.material];
  const MaterialPoint point = material_point(scene, material, ray, hit);
  Vertex vertex{point.surface, -ray.direction,
                scatter(scene.materials, shape.material, scene.textures, point, -ray.direction)};
  if (shape.light != kNone && dot(vertex.wo, point.surface.geometric_normal) > 0) {
    vertex.emission = evaluate_color(material.emission, scene.textures, point.texture);
    vertex.light = shape.light;
    vertex.light_hit = {point.surface.position, point.surface.geometric_normal, hit.primitive, hit.u, hit.v};
  }
  return vertex;
}

Spectrum pass_through(const RenderScene::Data& scene, const Ray& ray, const RayHit& hit) {
  const std::uint32_t index = scene.shapes[hit.shape].material;
  const Material& material = scene.materials[index];
  if (!material.may_pass) return Spectrum(0);
  const MaterialPoint point = material_point(scene, material, ray, hit);
  return scatter(scene.materials, index, scene.textures, point, -ray.direction).straight_through();
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
