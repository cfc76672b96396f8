#include "render/light_compiler.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "image/io.h"
#include "math/frame.h"
#include "render/area_light.h"
#include "render/material_compiler.h"
#include "render/shape_compiler.h"

namespace etendue {
namespace {

class LightCompiler {
 public:
  LightCompiler(const scene::SceneDescription& description, const CompileOptions& options, RenderScene::Data& data,
                Diagnostics& diagnostics)
      : scene_(description), options_(options), data_(data), diagnostics_(diagnostics) {}

  void run() {
    for (std::uint32_t shape = 0; shape < data_.shapes.size(); ++shape) shine(shape);
    for (const scene::Light& light : scene_.lights) add(light);
    if (options_.light_for) add(options_.light_for(data_.geometry.bounds()));
    data_.light_choice = LightChooser(data_.lights, data_.geometry.bounds(), options_.light_tree);
  }

 private:
  void shine(std::uint32_t shape);
  void add(const scene::Light& light);
  void add_rectangle(const scene::Light& light, const Spectrum& radiance);
  std::optional<Light> without_surface(const scene::Light& light);
  std::optional<Light> environment(const scene::EnvironmentLight& source, const scene::Light& light);

  const scene::SceneDescription& scene_;
  const CompileOptions& options_;
  RenderScene::Data& data_;
  Diagnostics& diagnostics_;
};

/// Makes a light of a shape if its material is one.
void LightCompiler::shine(std::uint32_t shape) {
  RenderScene::Data::ShapeInfo& info = data_.shapes[shape];
  const ColorSource& emission = data_.materials[info.material].emission;
  const auto* constant = std::get_if<Spectrum>(&emission);
  if (info.in_group || (constant != nullptr && constant->is_black())) return;
  const Geometry& geometry = data_.geometry;
  const Glow glow{&geometry, &data_.textures, shape, emission};
  const auto index = static_cast<std::uint32_t>(data_.lights.size());
  switch (geometry.kind(shape)) {
    case Geometry::Kind::mesh:
      if (constant)
        data_.lights.push_back(make_area_light(geometry.mesh(shape), *constant));
      else
        data_.lights.push_back(TexturedMeshLight(glow));
      break;
    case Geometry::Kind::sphere: {
      const SphereShape& sphere = geometry.sphere(shape);
      if (constant && !sphere.flip_normals)
        data_.lights.push_back(SphereLight{sphere.center, sphere.radius, *constant});
      else
        data_.lights.push_back(CurvedLight(glow));
      break;
    }
    case Geometry::Kind::disk:
    case Geometry::Kind::cylinder:
      data_.lights.push_back(CurvedLight(glow));
      break;
    case Geometry::Kind::curves:
      diagnostics_.repaired("light on curves left out: meshes, spheres, disks and cylinders can shine");
      return;
  }
  info.light = index;
}

void LightCompiler::add_rectangle(const scene::Light& light, const Spectrum& radiance) {
  const Transform& m = light.to_world;
  const Vec3 x = m.x * 0.5f, y = m.y * 0.5f;
  TriangleMesh mesh;
  mesh.positions = {m.origin - x - y, m.origin - x + y, m.origin + x + y, m.origin + x - y};  // clockwise seen from +z
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  if (m.determinant() < 0) mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  if (!(length(cross(x, y)) > 0) || std::ranges::any_of(mesh.positions, is_out_of_reach)) {
    diagnostics_.repaired("rectangle light without area or beyond 1e12 m left out", light.where);
    return;
  }
  data_.materials.push_back({UniformMaterial{BlackBsdf{}}, radiance});
  RenderScene::Data::ShapeInfo info;
  info.material = static_cast<std::uint32_t>(data_.materials.size() - 1);
  data_.shapes.push_back(info);
  shine(data_.geometry.add(std::move(mesh)));
}

std::optional<Light> LightCompiler::environment(const scene::EnvironmentLight& source, const scene::Light& light) {
  EnvironmentLight out;
  out.map = read_image(source.file, ColorEncoding::srgb);
  const MapRepairs repairs = repair_map(out.map);
  if (repairs.invalid > 0)
    diagnostics_.warning(fmt::format("{}: {} texels are NaN, infinite or negative; they count as black",
                                     source.file.string(), repairs.invalid),
                         light.where);
  if (repairs.black) {
    diagnostics_.warning(fmt::format("{}: the environment map is all black; it is left out", source.file.string()),
                         light.where);
    return std::nullopt;
  }
  out.importance = options_.environment_sampling == EnvironmentSampling::importance;
  out.intensity = source.intensity;
  out.orientation = {radians(source.rotation_deg), source.mirrored};
  const Transform& m = light.to_world;
  const Vec3 x = normalize(m.x), y = normalize(m.y), z = normalize(m.z);
  if (is_finite(x) && is_finite(y) && is_finite(z)) {
    out.axes = {x, y, z};
    out.turned = x != Vec3(1, 0, 0) || y != Vec3(0, 1, 0) || z != Vec3(0, 0, 1);
  }
  // All who sample it weigh the samples with those of the BSDF or phase function (direct_light.h).
  out.distribution = TexelDistribution(compensated(lookup_means(out.map, out.orientation.rows())));
  return out;
}

std::optional<Light> LightCompiler::without_surface(const scene::Light& light) {
  const Transform& m = light.to_world;
  const auto axis = [&] { return normalize(m.vector({0, 0, -1})); };
  struct Visitor {
    LightCompiler& compiler;
    const scene::Light& light;
    const Transform& m;
    decltype(axis)& direction;

    /// Orthonormal axes at the light: the direction that it shines in first, then up.
    Transform frame() const {
      const Vec3 back = -direction();
      const Vec3 right = normalize(cross(m.y, back));
      const Vec3 up = cross(back, right);
      const float side = m.determinant() < 0 ? -1.0f : 1.0f;  // mirrored lamps show mirrored pictures
      if (!is_finite(right)) {
        const Frame any = Frame::from_normal(back);
        return {any.s, any.t, any.n, m.origin};
      }
      return {right * side, up, back, m.origin};
    }

    std::optional<Light> operator()(const scene::PointLight& l) const { return PointLight{m.origin, l.intensity}; }
    std::optional<Light> operator()(const scene::SpotLight& l) const {
      SpotLight spot{frame(), l.intensity};
      spot.cutoff = radians(std::min(l.cutoff_deg, 180.0f));
      spot.beam = radians(std::min(l.beam_deg.value_or(l.cutoff_deg), 180.0f));
      spot.exponent = l.falloff_exponent;
      if (l.texture) spot.picture = l.texture->index;
      spot.textures = &compiler.data_.textures;
      return spot;
    }
    std::optional<Light> operator()(const scene::ProjectorLight& l) const {
      const float half = std::tan(radians(0.5f * l.xfov_deg));
      return ProjectorLight{
          frame(), half, half / l.aspect, l.scale, compile_input(l.irradiance), &compiler.data_.textures};
    }
    std::optional<Light> operator()(const scene::DirectionalLight& l) const {
      return DirectionalLight{-direction(), l.irradiance};
    }
    std::optional<Light> operator()(const scene::HemisphereLight& l) const {
      if (l.radiance.is_black()) return std::nullopt;
      return UniformLight{l.radiance, true};
    }
    std::optional<Light> operator()(const scene::EnvironmentLight& l) const { return compiler.environment(l, light); }
    std::optional<Light> operator()(const scene::RectangleLight&) const { return std::nullopt; }
    std::optional<Light> operator()(const scene::ConstantLight& l) const {
      if (l.radiance.is_black()) return std::nullopt;
      return UniformLight{l.radiance};
    }
  };
  return std::visit(Visitor{*this, light, m, axis}, light.source);
}

void LightCompiler::add(const scene::Light& light) {
  if (const auto* rectangle = std::get_if<scene::RectangleLight>(&light.source)) {
    if (!rectangle->radiance.is_black()) add_rectangle(light, rectangle->radiance);
    return;
  }
  std::optional<Light> compiled = without_surface(light);
  if (!compiled) return;
  if (is_infinite(*compiled)) data_.infinite_lights.push_back(static_cast<std::uint32_t>(data_.lights.size()));
  data_.lights.push_back(std::move(*compiled));
}

}  // namespace

void compile_lights(const scene::SceneDescription& scene, const CompileOptions& options, RenderScene::Data& data,
                    Diagnostics& diagnostics) {
  LightCompiler(scene, options, data, diagnostics).run();
}

}  // namespace etendue
