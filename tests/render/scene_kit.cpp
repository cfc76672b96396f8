#include "scene_kit.h"

#include <gtest/gtest.h>

#include "image/io.h"
#include "render/session.h"

namespace etendue {

MaterialId SceneKit::material(const scene::Surface& surface, const Spectrum& emission) {
  scene_.materials.push_back({"material", surface, emission, {}});
  return {static_cast<std::uint32_t>(scene_.materials.size() - 1)};
}

void SceneKit::mesh(std::vector<Point3> positions, std::vector<std::array<std::uint32_t, 3>> triangles,
                    MaterialId material, std::vector<Vec3> normals) {
  scene::Mesh mesh;
  mesh.positions = std::move(positions);
  mesh.normals = std::move(normals);
  mesh.triangles = std::move(triangles);
  scene_.meshes.push_back(std::move(mesh));
  const scene::Id<scene::Mesh> id{static_cast<std::uint32_t>(scene_.meshes.size() - 1)};
  scene_.instances.push_back({"mesh", id, material, {}, {}});
}

void SceneKit::quad(const Point3& corner, const Vec3& edge_x, const Vec3& edge_y, MaterialId material) {
  quad_grid(corner, edge_x, edge_y, 1, material);
}

void SceneKit::quad_grid(const Point3& corner, const Vec3& edge_x, const Vec3& edge_y, int n, MaterialId material) {
  std::vector<Point3> positions;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      positions.push_back(corner + edge_x * (static_cast<float>(i) / static_cast<float>(n)) +
                          edge_y * (static_cast<float>(j) / static_cast<float>(n)));
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto row = static_cast<std::uint32_t>(n + 1);
  for (std::uint32_t j = 0; j + 1 < row; ++j)
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t a = j * row + i;
      triangles.push_back({a, a + 1, a + row + 1});
      triangles.push_back({a, a + row + 1, a + row});
    }
  mesh(std::move(positions), std::move(triangles), material);
}

void SceneKit::sphere(const Point3& center, float radius, MaterialId material) {
  scene_.spheres.push_back({"sphere", radius, {}});
  const scene::Id<scene::Sphere> id{static_cast<std::uint32_t>(scene_.spheres.size() - 1)};
  scene_.instances.push_back({"sphere", id, material, Transform::translation(center), {}});
}

void SceneKit::triangulated_sphere(const Point3& center, float radius, int rings, MaterialId material) {
  const auto sectors = static_cast<std::uint32_t>(2 * rings);
  std::vector<Point3> positions;
  for (int ring = 0; ring <= rings; ++ring)
    for (std::uint32_t sector = 0; sector < sectors; ++sector) {
      const float theta = kPi * static_cast<float>(ring) / static_cast<float>(rings);
      const float phi = 2 * kPi * static_cast<float>(sector) / static_cast<float>(sectors);
      const Vec3 direction(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      positions.push_back(center + direction * radius);
    }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t ring = 0; ring < static_cast<std::uint32_t>(rings); ++ring)
    for (std::uint32_t sector = 0; sector < sectors; ++sector) {
      const std::uint32_t upper = ring * sectors + sector, upper_next = ring * sectors + (sector + 1) % sectors;
      const std::uint32_t lower = upper + sectors, lower_next = upper_next + sectors;
      if (ring > 0) triangles.push_back({upper, lower, upper_next});
      if (ring + 1 < static_cast<std::uint32_t>(rings)) triangles.push_back({upper_next, lower, lower_next});
    }
  mesh(std::move(positions), std::move(triangles), material);
}

void SceneKit::light(const scene::LightSource& source, const Transform& to_world) {
  scene_.lights.push_back({"light", source, to_world, {}});
}

scene::Id<scene::Volume> SceneKit::volume(scene::Volume volume) {
  scene_.volumes.push_back(std::move(volume));
  return {static_cast<std::uint32_t>(scene_.volumes.size() - 1)};
}

scene::Id<scene::Medium> SceneKit::medium(scene::Medium medium) {
  scene_.media.push_back(std::move(medium));
  return {static_cast<std::uint32_t>(scene_.media.size() - 1)};
}

void SceneKit::fill_last(scene::Id<scene::Medium> interior) {
  scene_.instances.back().separates_media = true;
  scene_.instances.back().interior = interior;
}

void SceneKit::camera_in(scene::Id<scene::Medium> medium) {
  scene_.cameras.assign(1, {});
  scene_.cameras.front().medium = medium;
}

RenderScene SceneKit::compile(const CompileOptions& options) const {
  Diagnostics diagnostics;
  RenderScene compiled = etendue::compile(scene_, options, diagnostics);
  for (const Diagnostic& diagnostic : diagnostics.all())
    if (diagnostic.severity != Severity::info) ADD_FAILURE() << diagnostics.format(diagnostic);
  return compiled;
}

Camera pinhole(const Point3& eye, const Point3& target, float half) {
  Camera camera;
  camera.to_world = Transform::look_at(eye, target, {0, 1, 0});
  camera.tan_half_x = camera.tan_half_y = half;
  return camera;
}

RenderSettings square_settings(int size, int samples_per_pixel, int max_depth) {
  RenderSettings settings;
  settings.width = settings.height = size;
  settings.samples_per_pixel = samples_per_pixel;
  settings.max_depth = max_depth;
  settings.integrator = IntegratorKind::path;
  settings.sampler = SamplerKind::independent;
  return settings;
}

Picture render(const RenderScene& scene, const Camera& camera, const RenderSettings& settings) {
  RenderSession session(scene, camera, settings);
  while (!session.finished()) session.render_pass({}, settings.samples_per_pixel);
  EXPECT_EQ(session.progress().invalid_samples, 0u) << session.progress().first_invalid;
  return session.snapshot();
}

scene::EnvironmentLight environment_map(const std::filesystem::path& path, const Image& map) {
  write_picture(path, Picture{map, {}, {}});
  return {path, 1, 0, false};
}

}  // namespace etendue
