#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "camera/placement.h"
#include "commands.h"
#include "formats/formats.h"
#include "render/render_scene.h"
#include "scene_loading.h"
#include "terminal.h"

namespace etendue {
namespace {

using Counts = std::map<std::string, std::size_t>;

const char* kind(const scene::DiffuseMaterial&) {
  return "diffuse";
}
const char* kind(const scene::MirrorMaterial&) {
  return "mirror";
}
const char* kind(const scene::GlassMaterial&) {
  return "glass";
}
const char* kind(const scene::RefractionMaterial&) {
  return "refraction";
}
const char* kind(const scene::ConductorMaterial&) {
  return "conductor";
}
const char* kind(const scene::NoReflection&) {
  return "no reflection";
}
const char* kind(const scene::PointLight&) {
  return "point";
}
const char* kind(const scene::SpotLight&) {
  return "spot";
}
const char* kind(const scene::DirectionalLight&) {
  return "directional";
}
const char* kind(const scene::RectangleLight&) {
  return "rectangle";
}
const char* kind(const scene::HemisphereLight&) {
  return "hemisphere";
}
const char* kind(const scene::EnvironmentLight&) {
  return "environment";
}
const char* kind(const scene::ThinGlassMaterial&) {
  return "thin glass";
}
const char* kind(const scene::RoughGlassMaterial&) {
  return "rough glass";
}
const char* kind(const scene::PlasticMaterial&) {
  return "plastic";
}
const char* kind(const scene::PrincipledMaterial&) {
  return "principled";
}
const char* kind(const scene::PrincipledThinMaterial&) {
  return "principled thin";
}
const char* kind(const scene::NullMaterial&) {
  return "null";
}
const char* kind(const scene::BlendMaterial&) {
  return "blend";
}
const char* kind(const scene::MaskMaterial&) {
  return "mask";
}
const char* kind(const scene::TwoSidedMaterial&) {
  return "two-sided";
}
const char* kind(const scene::BumpMaterial&) {
  return "bump map";
}
const char* kind(const scene::NormalMapMaterial&) {
  return "normal map";
}
const char* kind(const scene::ProjectorLight&) {
  return "projector";
}
const char* kind(const scene::ConstantLight&) {
  return "constant";
}
const char* kind(scene::Id<scene::Mesh>) {
  return "mesh";
}
const char* kind(scene::Id<scene::Sphere>) {
  return "sphere";
}
const char* kind(scene::Id<scene::Disk>) {
  return "disk";
}
const char* kind(scene::Id<scene::Cylinder>) {
  return "cylinder";
}
const char* kind(scene::Id<scene::Curves>) {
  return "curves";
}
const char* kind(scene::Id<scene::Group>) {
  return "group";
}

/// What `etendue info` says, ready to be printed either way.
struct SceneSummary {
  std::string file, format;
  bool uses_cgl_profile = false;
  std::size_t meshes = 0, spheres = 0, instances = 0, textures = 0, cameras = 0, emissive_materials = 0;
  std::size_t triangles_placed = 0, spheres_placed = 0;
  Counts materials, lights;
  Bounds3 bounds;
  const char* placement = "";
};

const char* automatic_placement(const scene::SceneDescription& scene) {
  if (scene.cameras.empty()) return "framed";
  return scene.uses_cgl_profile ? "fit" : "file";
}

SceneSummary summarize(const scene::SceneDescription& scene, const RenderScene& compiled) {
  SceneSummary s;
  s.file = scene.file.string();
  s.format = scene.format;
  s.uses_cgl_profile = scene.uses_cgl_profile;
  s.meshes = scene.meshes.size();
  s.spheres = scene.spheres.size();
  s.instances = scene.instances.size();
  s.textures = scene.textures.size();
  s.cameras = scene.cameras.size();
  for (const scene::Material& material : scene.materials) {
    ++s.materials[std::visit([](const auto& surface) { return kind(surface); }, material.surface)];
    if (scene::emits(material)) ++s.emissive_materials;
  }
  for (const scene::Light& light : scene.lights)
    ++s.lights[std::visit([](const auto& source) { return kind(source); }, light.source)];
  for (const scene::Instance& instance : scene.instances)
    if (emits(scene, instance)) ++s.lights[std::visit([](auto id) { return kind(id); }, instance.shape)];
  s.triangles_placed = compiled.triangle_count();
  s.spheres_placed = compiled.sphere_count();
  s.bounds = compiled.bounds();
  s.placement = automatic_placement(scene);
  return s;
}

std::string describe(const Counts& counts) {
  std::string text;
  for (const auto& [name, count] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  return text.empty() ? "none" : text;
}

std::string describe(const Point3& p) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z);
}

std::string as_table(const SceneSummary& s) {
  std::string text;
  const auto row = [&](std::string_view name, const std::string& value) {
    text += fmt::format("{:<12}{}\n", name, value);
  };
  row("file", s.file);
  row("format", s.format + (s.uses_cgl_profile ? ", CGL profile" : ""));
  row("meshes", fmt::format("{}", s.meshes));
  row("spheres", fmt::format("{}", s.spheres));
  row("instances", fmt::format("{} ({}, {})", s.instances, counted(s.triangles_placed, "triangle"),
                               counted(s.spheres_placed, "sphere")));
  row("materials",
      describe(s.materials) + (s.emissive_materials > 0 ? fmt::format("; {} of them emit{} light", s.emissive_materials,
                                                                      s.emissive_materials == 1 ? "s" : "")
                                                        : ""));
  row("textures", fmt::format("{}", s.textures));
  row("lights", describe(s.lights));
  row("cameras", fmt::format("{}; --camera-placement auto: {}", s.cameras, s.placement));
  row("bounds", describe(s.bounds.min) + " to " + describe(s.bounds.max));
  return text;
}

std::string as_json(const SceneSummary& s) {
  const auto point = [](const Point3& p) { return nlohmann::json{p.x, p.y, p.z}; };
  const nlohmann::ordered_json json = {
      {"file", s.file},
      {"format", s.format},
      {"cgl_profile", s.uses_cgl_profile},
      {"meshes", s.meshes},
      {"spheres", s.spheres},
      {"instances", s.instances},
      {"triangles_placed", s.triangles_placed},
      {"spheres_placed", s.spheres_placed},
      {"materials", s.materials},
      {"emissive_materials", s.emissive_materials},
      {"textures", s.textures},
      {"lights", s.lights},
      {"cameras", s.cameras},
      {"camera_placement", s.placement},
      {"bounds", {{"min", point(s.bounds.min)}, {"max", point(s.bounds.max)}}},
  };
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace

int run(const InfoOptions& options) {
  Diagnostics diagnostics;
  DiagnosticsPrinter printer(diagnostics);
  const scene::SceneDescription scene = read_scene(options.scene, diagnostics, options.read);
  const RenderScene compiled = compile(scene, {}, diagnostics);
  printer.print();
  const SceneSummary summary = summarize(scene, compiled);
  write_result(options.json ? as_json(summary) : as_table(summary));
  return 0;
}

}  // namespace etendue
