#include "formats/mitsuba/writer/shapes.h"

#include <fmt/format.h>

#include "formats/mesh/write_ply.h"
#include "formats/mitsuba/primitives.h"

namespace etendue::mitsuba {
namespace {

bool has_same_geometry(const scene::Mesh& a, const scene::Mesh& b) {
  return a.attributes.empty() && b.attributes.empty() && a.positions == b.positions && a.normals == b.normals &&
         a.uvs == b.uvs && a.triangles == b.triangles;
}

/// The mesh as a shape that needs no file: its type, and whether it is turned inside out.
struct Primitive {
  const char* type;
  bool flip_normals;
};

std::optional<Primitive> as_primitive(const scene::Mesh& mesh) {
  for (const bool flip : {false, true}) {
    if (has_same_geometry(mesh, rectangle(flip))) return Primitive{"rectangle", flip};
    if (has_same_geometry(mesh, cube(flip))) return Primitive{"cube", flip};
  }
  return std::nullopt;
}

/// Our spheres run around y, Mitsuba's around z, mirrored: (x, y, z) there is (−x, −z, y) here.
Transform of_mitsubas_sphere(const Transform& t) {
  return {-t.x, t.z, -t.y, t.origin};
}

/// Mitsuba turns spheres and cylinders inside out where they are mirrored.
bool flips_normals(const scene::Instance& instance, const Transform& to_world) {
  return instance.flip_normals != (to_world.determinant() < 0);
}

/// A line a control point, an empty one between two curves.
std::string curve_text(const scene::Curves& curves) {
  const std::uint32_t points_each = curves.basis == scene::Curves::Basis::linear ? 2 : 4;
  std::string text;
  for (std::size_t i = 0; i < curves.segments.size(); ++i) {
    const std::uint32_t first = curves.segments[i];
    const bool goes_on = i > 0 && first == curves.segments[i - 1] + 1;
    if (i > 0 && !goes_on) text += '\n';
    for (std::uint32_t p = goes_on ? first + points_each - 1 : first; p < first + points_each; ++p) {
      const Point3& x = curves.positions[p];
      text += fmt::format("{} {} {} {}\n", x.x, x.y, x.z, curves.radii[p]);
    }
  }
  return text;
}

void add_emitter(pugi::xml_node shape, const scene::ColorInput& radiance, TextureWriter& textures) {
  textures.add_emission(add_object(shape, "emitter", "area"), "radiance", radiance, TextureWriter::Use::color);
}

}  // namespace

void ShapeWriter::add(pugi::xml_node parent, const scene::Instance& instance, const scene::Camera* camera) {
  pugi::xml_node node = add_geometry(parent, instance);
  if (!node) return;
  add_material(node, instance, true);
  if (camera != nullptr) add_camera(node, *camera, context_, media_);
}

/// Ours spans ±½ and shines along −z, Mitsuba's ±1 and +z.
void ShapeWriter::add(pugi::xml_node parent, const scene::Light& light, const scene::RectangleLight& rectangle) {
  pugi::xml_node node = add_object(parent, "shape", "rectangle", context_.ids.telling(light.name, "rectangle"));
  const Transform& t = light.to_world;
  add_transform(node, "to_world", {t.x * 0.5f, t.y * -0.5f, -t.z, t.origin});
  add_emitter(node, rectangle.radiance, textures_);
}

pugi::xml_node ShapeWriter::add_geometry(pugi::xml_node parent, const scene::Instance& instance) {
  const auto add_shape = [&](const char* type) {
    return add_object(parent, "shape", type, context_.ids.telling(instance.name, type));
  };
  struct Visitor {
    ShapeWriter& writer;
    pugi::xml_node parent;
    const scene::Instance& instance;
    const decltype(add_shape)& add;

    pugi::xml_node operator()(scene::Id<scene::Mesh> id) const { return writer.add_mesh(parent, instance, id); }
    pugi::xml_node operator()(scene::Id<scene::Sphere> id) const {
      pugi::xml_node node = add("sphere");
      const Transform to_world = of_mitsubas_sphere(instance.to_world);
      add_number(node, "radius", writer.context_.scene.spheres[id.index].radius);
      add_transform(node, "to_world", to_world);
      add_flag(node, "flip_normals", flips_normals(instance, to_world));
      return node;
    }
    pugi::xml_node operator()(scene::Id<scene::Disk>) const {
      pugi::xml_node node = add("disk");
      add_transform(node, "to_world", instance.to_world);
      add_flag(node, "flip_normals", instance.flip_normals);
      return node;
    }
    pugi::xml_node operator()(scene::Id<scene::Cylinder>) const {
      pugi::xml_node node = add("cylinder");
      add_transform(node, "to_world", instance.to_world);
      add_flag(node, "flip_normals", flips_normals(instance, instance.to_world));
      return node;
    }
    pugi::xml_node operator()(scene::Id<scene::Curves> id) const {
      const bool is_linear = writer.context_.scene.curves[id.index].basis == scene::Curves::Basis::linear;
      pugi::xml_node node = add(is_linear ? "linearcurve" : "bsplinecurve");
      add_text(node, "filename", writer.curve_file(id));
      add_transform(node, "to_world", instance.to_world);
      return node;
    }
    pugi::xml_node operator()(scene::Id<scene::Group> id) const {
      const std::string& group = writer.group_id(id);
      pugi::xml_node node = add("instance");
      add_transform(node, "to_world", instance.to_world);
      add_reference(node, {}, group);
      return node;
    }
  };
  return std::visit(Visitor{*this, parent, instance, add_shape}, instance.shape);
}

/// Nothing if it has no triangles.
pugi::xml_node ShapeWriter::add_mesh(pugi::xml_node parent, const scene::Instance& instance,
                                     scene::Id<scene::Mesh> id) {
  const scene::Mesh& mesh = context_.scene.meshes[id.index];
  if (mesh.triangles.empty()) {
    context_.written_instead("a mesh without triangles is left out", mesh.where);
    return {};
  }
  const std::optional<Primitive> primitive = as_primitive(mesh);
  const char* const type = primitive ? primitive->type : "ply";
  pugi::xml_node node = add_object(parent, "shape", type, context_.ids.telling(instance.name, type));
  if (primitive) {
    add_flag(node, "flip_normals", primitive->flip_normals);
  } else {
    add_text(node, "filename", mesh_file(id));
    add_flag(node, "face_normals", mesh.normals.empty());
  }
  add_transform(node, "to_world", instance.to_world);
  return node;
}

void ShapeWriter::add_material(pugi::xml_node node, const scene::Instance& instance, bool may_shine) {
  media_.add(node, "interior", instance.interior);
  media_.add(node, "exterior", instance.exterior);
  if (std::holds_alternative<scene::Id<scene::Group>>(instance.shape)) return;
  const scene::Material& material = context_.scene.materials[instance.material.index];
  const bool shines = scene::emits(material) && may_shine;
  if (!shines || !std::holds_alternative<scene::NoReflection>(material.surface))  // lamps are black by themselves
    add_reference(node, {}, materials_.id(instance.material));
  if (shines) add_emitter(node, material.emission, textures_);
  if (scene::emits(material) && !may_shine)
    context_.written_instead("nothing in a group can shine; the light is left out", instance.where);
}

const std::string& ShapeWriter::mesh_file(scene::Id<scene::Mesh> id) {
  const auto [place, is_new] = mesh_files_.try_emplace(id.index);
  const scene::Mesh& mesh = context_.scene.meshes[id.index];
  if (is_new) place->second = context_.files.add(mesh.name.empty() ? "mesh" : mesh.name, ".ply", ply_bytes(mesh));
  return place->second;
}

const std::string& ShapeWriter::curve_file(scene::Id<scene::Curves> id) {
  const auto [place, is_new] = curve_files_.try_emplace(id.index);
  const scene::Curves& curves = context_.scene.curves[id.index];
  if (is_new)
    place->second = context_.files.add(curves.name.empty() ? "curves" : curves.name, ".txt", curve_text(curves));
  return place->second;
}

const std::string& ShapeWriter::group_id(scene::Id<scene::Group> id) {
  const auto [place, is_new] = group_ids_.try_emplace(id.index);
  if (!is_new) return place->second;
  const scene::Group& group = context_.scene.groups[id.index];
  place->second = context_.ids.unique(group.name, "group");
  pugi::xml_node node = add_object(groups_, "shape", "shapegroup", place->second);
  for (const scene::Instance& instance : group.instances) {
    if (std::holds_alternative<scene::Id<scene::Group>>(instance.shape))
      context_.written_instead("Mitsuba shows no groups within groups; one is written all the same", instance.where);
    if (pugi::xml_node shape = add_geometry(node, instance)) add_material(shape, instance, false);
  }
  return place->second;
}

}  // namespace etendue::mitsuba
