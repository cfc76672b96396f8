#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "image/io.h"
#include "render/area_light.h"
#include "render/scene_data.h"

namespace etendue {
namespace {

/// How far from the origin geometry may lie, in metres: beyond, the squares of distances between things would overflow.
constexpr float kReach = 1e12f;
bool is_out_of_reach(const Point3& p) {
  return !(max_abs_component(p) <= kReach);
}

/// Triangles below this, in square metres, lie at the end of float arithmetic: twice their area squared nears the
/// smallest of floats.
constexpr float kTinyArea = 1e-18f;

/// Brings every channel into [0, 1], NaN to 0; returns how many texels that changed.
std::size_t make_reflectance(Image& image) {
  std::size_t changed = 0;
  for (Spectrum& texel : image.pixels()) {
    const Spectrum before = texel;
    for (int c = 0; c < 3; ++c) texel[c] = texel[c] >= 0 ? std::min(texel[c], 1.0f) : 0.0f;
    changed += texel == before ? 0 : 1;
  }
  return changed;
}

/// Works through a description, room by room, and fills RenderScene::Data.
class Compiler {
 public:
  Compiler(const scene::SceneDescription& description, const CompileOptions& options, Diagnostics& diagnostics)
      : scene_(description), options_(options), diagnostics_(diagnostics) {}

  std::shared_ptr<const RenderScene::Data> run();

 private:
  void compile_textures();
  void compile_materials();
  void compile_instances();
  void compile_lights();
  void compile_light(const scene::Light& light);
  void compile_light_choice();

  Material compile_material(const scene::Material& material) const;
  ColorSource color(const scene::ColorInput& input) const;
  void add_mesh(TriangleMesh mesh, std::uint32_t material);
  void add_sphere(const SphereShape& sphere, std::uint32_t material);
  void add_rectangle(const scene::Light& light, const Spectrum& radiance);
  std::optional<Light> point_like_or_infinite(const scene::Light& light);
  std::optional<Light> environment(const scene::EnvironmentLight& source, const scene::Light& light);

  const scene::SceneDescription& scene_;
  const CompileOptions& options_;
  Diagnostics& diagnostics_;
  std::shared_ptr<RenderScene::Data> data_ = std::make_shared<RenderScene::Data>();
};

/// How many triangles of a scene are not what they should be.
struct TriangleRepairs {
  std::size_t dropped = 0, tiny = 0;
};

/// The mesh in world space. Its winding is made to agree with its normals, so that the front is on their side; normals
/// that say no more than the triangles themselves are left out. Triangles without area or out of reach are dropped and
/// counted, tiny ones counted.
TriangleMesh to_world(const scene::Mesh& mesh, const Transform& m, TriangleRepairs& repairs) {
  TriangleMesh out;
  out.positions.reserve(mesh.positions.size() + 2);
  for (const Point3& p : mesh.positions) out.positions.push_back(m.point(p));
  const bool mirrored = m.determinant() < 0;
  const float sign = mirrored ? -1.0f : 1.0f;
  for (const Vec3& n : mesh.normals) out.normals.push_back(normalize(m.normal(n) * sign));
  out.uvs = mesh.uvs;
  out.triangles.reserve(mesh.triangles.size());
  bool smooth = false;
  for (auto t : mesh.triangles) {
    if (mirrored) std::swap(t[1], t[2]);
    const Point3 &p0 = out.positions[t[0]], &p1 = out.positions[t[1]], &p2 = out.positions[t[2]];
    const Vec3 n = cross(p1 - p0, p2 - p0);
    const float l = length(n);
    if (!(l > 0) || !std::isfinite(l) || is_out_of_reach(p0) || is_out_of_reach(p1) || is_out_of_reach(p2)) {
      ++repairs.dropped;
      continue;
    }
    repairs.tiny += 0.5f * l < kTinyArea ? 1 : 0;
    if (!out.normals.empty()) {
      const Vec3 unit = n * (1 / l);
      const float a = dot(unit, out.normals[t[0]]), b = dot(unit, out.normals[t[1]]), c = dot(unit, out.normals[t[2]]);
      if (a + b + c < 0) std::swap(t[1], t[2]);
      smooth = smooth || std::min({std::abs(a), std::abs(b), std::abs(c)}) < 1 - 1e-6f;
    }
    out.triangles.push_back(t);
  }
  if (!smooth) out.normals = {};
  return out;
}

std::shared_ptr<const RenderScene::Data> Compiler::run() {
  const auto start = std::chrono::steady_clock::now();
  compile_textures();
  compile_materials();
  compile_instances();
  compile_lights();
  if (data_->geometry.shape_count() == 0)
    throw Error(
        Failure::input,
        fmt::format("{}: nothing to render: the scene has no geometry. Does its <visual_scene> instantiate any?",
                    scene_.file.string()));
  data_->geometry.build();
  compile_light_choice();
  data_->build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return data_;
}

void Compiler::compile_textures() {
  for (const scene::Texture& texture : scene_.textures) {
    try {
      data_->textures.push_back(read_image(texture.file));
      diagnostics_.repaired("texel that is no reflectance between 0 and 1 brought there", texture.where,
                            make_reflectance(data_->textures.back()));
    } catch (const Error& error) {
      diagnostics_.warning(fmt::format("{}; the texture is replaced by grey", error.what()), texture.where);
      data_->textures.emplace_back(1, 1, Spectrum(0.5f));
    }
  }
}

ColorSource Compiler::color(const scene::ColorInput& input) const {
  if (const auto* texture = std::get_if<scene::Id<scene::Texture>>(&input)) return texture->index;
  return std::get<Spectrum>(input);
}

Material Compiler::compile_material(const scene::Material& material) const {
  struct Visitor {
    const Compiler& compiler;

    Material operator()(const scene::DiffuseMaterial& m) const {
      const ColorSource reflectance = compiler.color(m.reflectance);
      if (const auto* constant = std::get_if<Spectrum>(&reflectance))
        return {UniformMaterial{DiffuseBsdf{*constant}}, {}};
      return {DiffuseMaterial{reflectance}, {}};
    }
    Material operator()(const scene::MirrorMaterial& m) const {
      return {UniformMaterial{MirrorBsdf{m.reflectance}}, {}};
    }
    Material operator()(const scene::GlassMaterial& m) const {
      const scene::Fresnel fresnel = compiler.options_.fresnel.value_or(m.fresnel);
      return {
          UniformMaterial{DielectricBsdf{m.reflectance, m.transmittance, m.ior, fresnel == scene::Fresnel::schlick}},
          {}};
    }
    Material operator()(const scene::RefractionMaterial& m) const {
      return {UniformMaterial{RefractionBsdf{m.transmittance, m.ior}}, {}};
    }
    Material operator()(const scene::ConductorMaterial& m) const {
      const auto kind = m.distribution == scene::Microfacets::ggx ? MicrofacetKind::ggx : MicrofacetKind::beckmann;
      return {UniformMaterial{ConductorBsdf{m.eta, m.k, m.reflectance, MicrofacetDistribution(kind, m.alpha)}}, {}};
    }
    Material operator()(const scene::NoReflection&) const { return {UniformMaterial{BlackBsdf{}}, {}}; }
  };
  Material out = std::visit(Visitor{*this}, material.surface);
  out.emission = material.emission;
  return out;
}

void Compiler::compile_materials() {
  for (const scene::Material& material : scene_.materials) data_->materials.push_back(compile_material(material));
}

void Compiler::add_mesh(TriangleMesh mesh, std::uint32_t material) {
  const Spectrum emission = data_->materials[material].emission;
  RenderScene::Data::ShapeInfo info{material, kNone};
  if (!emission.is_black()) {
    info.light = static_cast<std::uint32_t>(data_->lights.size());
    data_->lights.push_back(make_area_light(mesh, emission));
  }
  data_->geometry.add(std::move(mesh));
  data_->shapes.push_back(info);
}

void Compiler::add_sphere(const SphereShape& sphere, std::uint32_t material) {
  const Spectrum emission = data_->materials[material].emission;
  RenderScene::Data::ShapeInfo info{material, kNone};
  if (!emission.is_black()) {
    info.light = static_cast<std::uint32_t>(data_->lights.size());
    data_->lights.push_back(SphereLight{sphere.center, sphere.radius, emission});
  }
  data_->geometry.add(sphere);
  data_->shapes.push_back(info);
}

void Compiler::compile_instances() {
  TriangleRepairs repairs;
  for (const scene::Instance& instance : scene_.instances) {
    const Transform& m = instance.to_world;
    if (const auto* id = std::get_if<scene::Id<scene::Sphere>>(&instance.shape)) {
      const float scale = std::cbrt(std::abs(m.determinant()));
      const float radius = scene_.spheres[id->index].radius * scale;
      if (!(radius > 0) || !std::isfinite(radius) || !is_finite(m.origin)) {
        diagnostics_.repaired("sphere without extent left out", instance.where);
        continue;
      }
      if (is_out_of_reach(m.origin) || radius > kReach) {
        diagnostics_.repaired("sphere that reaches beyond 1e12 m left out", instance.where);
        continue;
      }
      const Vec3 pole = normalize(m.y);
      add_sphere({m.origin, radius, pole, normalize(m.x - pole * dot(m.x, pole))}, instance.material.index);
      continue;
    }
    const scene::Mesh& mesh = scene_.meshes[std::get<scene::Id<scene::Mesh>>(instance.shape).index];
    TriangleMesh world = to_world(mesh, m, repairs);
    if (!world.triangles.empty()) add_mesh(std::move(world), instance.material.index);
  }
  diagnostics_.repaired("triangle without area or beyond 1e12 m left out", {}, repairs.dropped);
  diagnostics_.repaired("triangle below 1e-18 m² rendered with few exact digits: a larger <unit> helps", {},
                        repairs.tiny);
}

void Compiler::add_rectangle(const scene::Light& light, const Spectrum& radiance) {
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
  data_->materials.push_back({UniformMaterial{BlackBsdf{}}, radiance});
  add_mesh(std::move(mesh), static_cast<std::uint32_t>(data_->materials.size() - 1));
}

std::optional<Light> Compiler::environment(const scene::EnvironmentLight& source, const scene::Light& light) {
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
  out.distribution = TexelDistribution(lookup_means(out.map, out.orientation.rows()));
  return out;
}

std::optional<Light> Compiler::point_like_or_infinite(const scene::Light& light) {
  const Transform& m = light.to_world;
  const auto axis = [&] { return normalize(m.vector({0, 0, -1})); };
  struct Visitor {
    Compiler& compiler;
    const scene::Light& light;
    const Transform& m;
    decltype(axis)& direction;

    std::optional<Light> operator()(const scene::PointLight& l) const { return PointLight{m.origin, l.intensity}; }
    std::optional<Light> operator()(const scene::SpotLight& l) const {
      return SpotLight{m.origin, direction(), l.intensity, std::cos(radians(std::min(l.cutoff_deg, 180.0f))),
                       l.falloff_exponent};
    }
    std::optional<Light> operator()(const scene::DirectionalLight& l) const {
      return DirectionalLight{-direction(), l.irradiance};
    }
    std::optional<Light> operator()(const scene::HemisphereLight& l) const {
      if (l.radiance.is_black()) return std::nullopt;
      return HemisphereLight{l.radiance};
    }
    std::optional<Light> operator()(const scene::EnvironmentLight& l) const { return compiler.environment(l, light); }
    std::optional<Light> operator()(const scene::RectangleLight&) const { return std::nullopt; }
  };
  return std::visit(Visitor{*this, light, m, axis}, light.source);
}

void Compiler::compile_light(const scene::Light& light) {
  if (const auto* rectangle = std::get_if<scene::RectangleLight>(&light.source)) {
    if (!rectangle->radiance.is_black()) add_rectangle(light, rectangle->radiance);
    return;
  }
  std::optional<Light> compiled = point_like_or_infinite(light);
  if (!compiled) return;
  if (is_infinite(*compiled)) data_->infinite_lights.push_back(static_cast<std::uint32_t>(data_->lights.size()));
  data_->lights.push_back(std::move(*compiled));
}

void Compiler::compile_lights() {
  for (const scene::Light& light : scene_.lights) compile_light(light);
  if (options_.light_for) compile_light(options_.light_for(data_->geometry.bounds()));
}

void Compiler::compile_light_choice() {
  if (data_->lights.empty()) return;
  std::vector<double> power;
  double total = 0;
  for (const Light& light : data_->lights) {
    power.push_back(light_power(light, data_->geometry.bounds()));
    total += power.back();
  }
  // A quarter of the choices ignores power: a weak light may be the only one that matters where it stands.
  for (double& p : power) p = 0.75 * p + 0.25 * total / static_cast<double>(power.size());
  data_->light_choice = DiscreteDistribution(power);
}

}  // namespace

RenderScene compile(const scene::SceneDescription& scene, const CompileOptions& options, Diagnostics& diagnostics) {
  return RenderScene(Compiler(scene, options, diagnostics).run());
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
