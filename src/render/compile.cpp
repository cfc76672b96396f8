#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "render/light_compiler.h"
#include "render/material_compiler.h"
#include "render/media_compiler.h"
#include "render/scene_data.h"
#include "render/shape_compiler.h"

namespace etendue {

namespace {

/// The shape that the camera measures the irradiance of, if it does.
std::optional<std::uint32_t> measured_shape(const scene::SceneDescription& scene, const RenderScene::Data& data) {
  if (scene.cameras.empty() || scene.cameras.front().projection != scene::Projection::irradiance) return std::nullopt;
  const scene::Camera& camera = scene.cameras.front();
  const std::uint32_t shape = camera.measured_shape ? data.first_shape_of_instance[*camera.measured_shape] : kNone;
  if (shape == kNone || data.geometry.kind(shape) == Geometry::Kind::curves)
    throw Error(Failure::input,
                fmt::format("{}: the irradiance meter has no surface with an area to measure; put it into a mesh, "
                            "sphere, disk or cylinder",
                            scene.file.string()));
  return shape;
}

}  // namespace

RenderScene compile(const scene::SceneDescription& scene, const CompileOptions& options, Diagnostics& diagnostics) {
  const auto start = std::chrono::steady_clock::now();
  auto data = std::make_shared<RenderScene::Data>();
  data->textures = compile_textures(scene, data->geometry, diagnostics);
  data->materials = compile_materials(scene, options, diagnostics);
  data->media = compile_media(scene, diagnostics);
  if (!scene.cameras.empty() && scene.cameras.front().medium) data->camera_medium = scene.cameras.front().medium->index;
  compile_shapes(scene, *data, diagnostics);
  compile_lights(scene, options, *data, diagnostics);
  if (data->geometry.shape_count() == 0)
    throw Error(Failure::input,
                fmt::format("{}: nothing to render: the scene has no geometry. Does it place any in the world?",
                            scene.file.string()));
  if (const std::optional<std::uint32_t> shape = measured_shape(scene, *data))
    data->measured.emplace(data->geometry, *shape);
  data->may_pass =
      std::ranges::any_of(data->shapes, [&](const auto& shape) { return data->materials[shape.material].may_pass; });
  data->geometry.build();
  data->build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return RenderScene(std::move(data));
}

const Bounds3& RenderScene::bounds() const {
  return data_->geometry.bounds();
}
std::size_t RenderScene::triangle_count() const {
  return data_->geometry.triangle_count();
}
std::size_t RenderScene::sphere_count() const {
  return data_->geometry.sphere_count();
}
std::size_t RenderScene::light_count() const {
  return data_->lights.size();
}
double RenderScene::build_seconds() const {
  return data_->build_seconds;
}

std::optional<float> RenderScene::depth_at(const Camera& camera, int x, int y, int width, int height) const {
  Camera pinhole = camera;
  pinhole.lens_radius = 0;
  const Vec2 film((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                  (static_cast<float>(y) + 0.5f) / static_cast<float>(height));
  const Ray ray = generate_ray(pinhole, film, {0.5f, 0.5f});
  const RayHit hit = data_->geometry.intersect(ray);
  if (!hit.found()) return std::nullopt;
  return -dot(ray.direction, camera.to_world.z) * hit.t;
}

}  // namespace etendue
