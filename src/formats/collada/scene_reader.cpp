#include "formats/collada/scene_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/collada/geometry.h"
#include "formats/collada/lights_cameras.h"
#include "formats/collada/materials.h"
#include "formats/collada/one_light.h"
#include "formats/collada/transforms.h"

namespace etendue::collada {
namespace {

constexpr std::size_t kDeepestNesting = 200;
/// Bounds on what a small file can unfold to: elements repeated by instance_node, and shapes placed in all.
constexpr std::size_t kMostRepeatedElements = 1'000'000, kMostInstances = 2'000'000;

bool is_finite(const Transform& t) {
  return etendue::is_finite(t.x) && etendue::is_finite(t.y) && etendue::is_finite(t.z) && etendue::is_finite(t.origin);
}

/// Finite, and with a volume that is more than rounding error.
bool is_invertible(const Transform& t) {
  if (!is_finite(t)) return false;
  const Imath::V3d x(t.x), y(t.y), z(t.z);
  const double most = x.length() * y.length() * z.length();
  return std::abs(x.dot(y.cross(z))) > 1e-7 * most && etendue::is_finite(t.inverse().x);
}

/// Whether a sphere stays a sphere.
bool is_uniform_scale(const Transform& t) {
  constexpr float kTolerance = 1e-3f;
  const float x2 = length_squared(t.x), y2 = length_squared(t.y), z2 = length_squared(t.z);
  const float most = kTolerance * std::max({x2, y2, z2});
  return std::abs(x2 - y2) <= most && std::abs(y2 - z2) <= most && std::abs(dot(t.x, t.y)) <= most &&
         std::abs(dot(t.y, t.z)) <= most && std::abs(dot(t.z, t.x)) <= most;
}

/// Walks the nodes of the visual scene and collects what they instance.
class SceneReader {
 public:
  SceneReader(const Document& document, Report& report)
      : document_(document), report_(report), geometries_(document, report), materials_(document, report) {}

  scene::SceneDescription read();

 private:
  /// A material bound to a symbol, by <instance_material>.
  struct Binding {
    std::string_view symbol;
    scene::Id<scene::Material> material;
  };

  pugi::xml_node visual_scene() const;
  void place_node(pugi::xml_node node, const Transform& parent);
  void place_children(pugi::xml_node node, const Transform& to_world);
  void place_instance(pugi::xml_node node, pugi::xml_node element, const Transform& to_world);
  void place_instanced_node(pugi::xml_node element, const Transform& to_world);
  void place_geometry(pugi::xml_node node, pugi::xml_node element, const Transform& to_world);
  void place_light(pugi::xml_node node, pugi::xml_node element, const Transform& to_world);
  void place_camera(pugi::xml_node element, const Transform& to_world);
  std::vector<Binding> read_bindings(pugi::xml_node element);
  scene::Id<scene::Material> bound_material(const std::vector<Binding>& bindings, const Part& part,
                                            SourceLocation where);
  Transform sphere_transform(const Transform& to_world, SourceLocation where);

  const Document& document_;
  Report& report_;
  GeometryLibrary geometries_;
  MaterialLibrary materials_;
  scene::SceneDescription scene_;
  std::vector<pugi::xml_node> path_;  ///< the nodes around the one that is read
  std::size_t instancing_depth_ = 0, repeated_elements_ = 0;
};

scene::SceneDescription SceneReader::read() {
  const Transform world = file_to_world(document_, report_);
  try {
    place_children(visual_scene(), world);
  } catch (const Problem& problem) {
    report_.error(problem);
  }
  scene_.meshes = geometries_.take_meshes();
  scene_.spheres = geometries_.take_spheres();
  scene_.materials = materials_.take_materials();
  scene_.textures = materials_.take_textures();
  scene_.lights = without_doubled_lights(scene_, report_);
  scene_.uses_cgl_profile = document_.uses_cgl_profile();
  return std::move(scene_);
}

pugi::xml_node SceneReader::visual_scene() const {
  const pugi::xml_node scene = document_.root().child("scene");
  const pugi::xml_node instance = scene.child("instance_visual_scene");
  if (!instance)
    throw Problem(fmt::format("{}: nothing says which visual scene to show; add <scene><instance_visual_scene "
                              "url=\"#…\"/></scene>",
                              scene ? "<scene> has no <instance_visual_scene>" : "the file has no <scene>"),
                  document_.locate(scene ? scene : document_.root()));
  return document_.referenced(instance, "url", "visual_scene");
}

void SceneReader::place_node(pugi::xml_node node, const Transform& parent) {
  const SourceLocation where = document_.locate(node);
  if (path_.size() >= kDeepestNesting)
    throw Problem(fmt::format("nodes are nested more than {} deep", kDeepestNesting), where);
  Transform local;
  try {
    local = node_transform(document_, report_, node);
  } catch (const Problem& problem) {
    report_.error(problem);
    return;
  }
  path_.push_back(node);
  place_children(node, parent * local);
  path_.pop_back();
}

void SceneReader::place_children(pugi::xml_node node, const Transform& to_world) {
  for (const pugi::xml_node child : node.children()) {
    if (instancing_depth_ > 0 && ++repeated_elements_ > kMostRepeatedElements)
      throw Problem(fmt::format("instance_node unfolds this file to more than {} elements", kMostRepeatedElements),
                    document_.locate(child));
    if (std::string_view(child.name()) == "node")
      place_node(child, to_world);
    else
      place_instance(node, child, to_world);
  }
}

void SceneReader::place_instance(pugi::xml_node node, pugi::xml_node element, const Transform& to_world) {
  const std::string_view kind = element.name();
  if (kind == "instance_node") return place_instanced_node(element, to_world);
  try {
    if (kind == "instance_geometry") place_geometry(node, element, to_world);
  } catch (const Problem& problem) {
    report_.error(problem);
  }
  try {
    if (kind == "instance_light") place_light(node, element, to_world);
    if (kind == "instance_camera") place_camera(element, to_world);
  } catch (const Problem& problem) {
    report_.warning(problem);
  }
  if (kind == "instance_controller")
    report_.repaired("skinned and morphed geometry (instance_controller) is not supported; it is left out",
                     document_.locate(element));
}

void SceneReader::place_instanced_node(pugi::xml_node element, const Transform& to_world) {
  pugi::xml_node target;
  try {
    target = document_.referenced(element, "url", "node");
  } catch (const Problem& problem) {
    report_.error(problem);
    return;
  }
  if (std::find(path_.begin(), path_.end(), target) != path_.end())
    throw Problem(
        fmt::format("instance_node puts the node {} inside itself", in_quotes(target.attribute("id").value())),
        document_.locate(element));
  ++instancing_depth_;
  place_node(target, to_world);
  --instancing_depth_;
}

void SceneReader::place_geometry(pugi::xml_node node, pugi::xml_node element, const Transform& to_world) {
  const SourceLocation where = document_.locate(element);
  const std::vector<Part>& parts = geometries_.parts(document_.referenced(element, "url", "geometry"));
  const std::vector<Binding> bindings = read_bindings(element);
  if (!is_invertible(to_world))
    return report_.repaired("a geometry's transform is singular or not finite; it is left out", where);
  if (scene_.instances.size() + parts.size() > kMostInstances)
    throw Problem(fmt::format("the scene has more than {} instances", kMostInstances), where);
  for (const Part& part : parts) {
    const bool is_sphere = std::holds_alternative<scene::Id<scene::Sphere>>(part.shape);
    scene::Instance instance;
    instance.name = name_of(node);
    std::visit([&](auto id) { instance.shape = id; }, part.shape);
    instance.material = bound_material(bindings, part, where);
    instance.to_world = is_sphere ? sphere_transform(to_world, where) : to_world;
    instance.where = where;
    scene_.instances.push_back(std::move(instance));
  }
}

std::vector<SceneReader::Binding> SceneReader::read_bindings(pugi::xml_node element) {
  std::vector<Binding> bindings;
  for (const pugi::xml_node binding :
       element.child("bind_material").child("technique_common").children("instance_material")) {
    const pugi::xml_node material = document_.referenced(binding, "target", "material");
    bindings.push_back({binding.attribute("symbol").value(), materials_.material(material)});
  }
  return bindings;
}

/// What is bound to the part's symbol. A part without symbol takes the first there is.
scene::Id<scene::Material> SceneReader::bound_material(const std::vector<Binding>& bindings, const Part& part,
                                                       SourceLocation where) {
  for (const Binding& binding : bindings)
    if (part.material_symbol.empty() || part.material_symbol == binding.symbol) return binding.material;
  report_.repaired("no material is bound to a part of this geometry; grey (0.5) is used", where);
  return materials_.default_material();
}

Transform SceneReader::sphere_transform(const Transform& to_world, SourceLocation where) {
  if (is_uniform_scale(to_world)) return to_world;
  report_.repaired("a sphere is scaled unevenly; it stays a sphere, of the same volume", where);
  Transform sphere = Transform::scaling(Vec3(std::cbrt(std::abs(to_world.determinant()))));
  sphere.origin = to_world.origin;
  return sphere;
}

void SceneReader::place_light(pugi::xml_node node, pugi::xml_node element, const Transform& to_world) {
  const auto source = read_light(document_, report_, document_.referenced(element, "url", "light"));
  if (!source) return;
  const SourceLocation where = document_.locate(element);
  if (!is_invertible(to_world))
    return report_.repaired("a light's transform is singular or not finite; it is left out", where);
  scene_.lights.push_back({name_of(node), *source, to_world, where});
}

void SceneReader::place_camera(pugi::xml_node element, const Transform& to_world) {
  scene::Camera camera = read_camera(document_, report_, document_.referenced(element, "url", "camera"));
  if (!is_invertible(to_world))
    return report_.repaired("a camera's transform is singular or not finite; it is left out",
                            document_.locate(element));
  camera.to_world = to_world;
  camera.near_clip *= length(to_world.z);
  camera.far_clip *= length(to_world.z);
  scene_.cameras.push_back(std::move(camera));
}

}  // namespace

scene::SceneDescription read_scene(const Document& document, Report& report) {
  return SceneReader(document, report).read();
}

}  // namespace etendue::collada
