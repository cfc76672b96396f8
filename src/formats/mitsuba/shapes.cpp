#include "formats/mitsuba/shapes.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "formats/mesh/obj.h"
#include "formats/mesh/ply.h"
#include "formats/mesh/serialized.h"
#include "formats/mitsuba/curves.h"
#include "formats/mitsuba/emitters.h"
#include "formats/mitsuba/primitives.h"
#include "formats/mitsuba/transforms.h"
#include "math/frame.h"

namespace etendue::mitsuba {
namespace {

template <typename T>
scene::Id<T> add(std::vector<T>& all, T one) {
  all.push_back(std::move(one));
  return {static_cast<std::uint32_t>(all.size() - 1)};
}

bool is_mesh_file(std::string_view type) {
  return type == "obj" || type == "ply" || type == "serialized";
}

/// Our spheres have their v = 1 at +y and u growing around it; Mitsuba's v = 1 at −z and u growing around +z from +x:
/// the same by a reflection.
Transform sphere_coordinates() {
  return {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, 0, 0}};
}

bool keeps_spheres_round(const Transform& t) {
  const float x2 = length_squared(t.x), y2 = length_squared(t.y), z2 = length_squared(t.z);
  const float most = 1e-3f * std::max({x2, y2, z2});
  return std::abs(x2 - y2) <= most && std::abs(y2 - z2) <= most && std::abs(dot(t.x, t.y)) <= most &&
         std::abs(dot(t.y, t.z)) <= most && std::abs(dot(t.z, t.x)) <= most;
}

/// Whatever a shape's own reader throws belongs to the place where the scene names the file.
template <typename Function>
auto read_at(SourceLocation where, Function function) {
  try {
    return function();
  } catch (const Error& error) {
    throw Problem(error.what(), where);
  }
}

}  // namespace

std::optional<Sensor> ShapeReader::place(const Element& element) {
  if (element.type() == "shapegroup") return std::nullopt;  // it is seen where an instance shows it
  Properties properties(document_, element, report_);
  std::optional<scene::Instance> instance = read(properties);
  if (!instance) return std::nullopt;
  read_material(properties, *instance, true);
  std::optional<Sensor> sensor;
  if (const Element* inner = properties.object("sensor")) sensor = read_sensor(document_, *inner, media_, report_);
  properties.reject_unread();
  if (sensor) sensor->camera.measured_shape = static_cast<std::uint32_t>(scene_.instances.size());
  scene_.instances.push_back(*std::move(instance));
  return sensor;
}

/// The shape where it stands; nothing, with a warning, if it is not known.
std::optional<scene::Instance> ShapeReader::read(Properties& properties) {
  scene::Instance instance;
  instance.name = properties.name();
  instance.where = properties.where();
  instance.to_world = properties.transform("to_world");
  if (!read_geometry(properties, instance)) {
    report_.warning(fmt::format("the shape {} is not known here; it is left out", in_quotes(properties.type())),
                    properties.where());
    return std::nullopt;
  }
  read_media(properties, instance);
  properties.ignore({"silhouette_sampling_weight"});
  if (!properties.objects("texture").empty())
    report_.repaired("textures that stand in a shape itself are left out", properties.where());
  return instance;
}

bool ShapeReader::read_geometry(Properties& properties, scene::Instance& instance) {
  const std::string_view type = properties.type();
  if (is_mesh_file(type)) {
    instance.shape = read_mesh_file(properties);
  } else if (type == "rectangle" || type == "cube") {
    properties.ignore({"face_normals"});
    const bool flip = properties.boolean("flip_normals", false);
    scene::Mesh mesh = type == "cube" ? cube(flip) : rectangle(flip);
    mesh.where = properties.where();
    instance.shape = add(scene_.meshes, std::move(mesh));
  } else if (type == "sphere") {
    read_sphere(properties, instance);
  } else if (type == "disk") {
    instance.shape = add(scene_.disks, scene::Disk{instance.name, instance.where});
    instance.flip_normals = properties.boolean("flip_normals", false);
  } else if (type == "cylinder") {
    read_cylinder(properties, instance);
  } else if (type == "bsplinecurve" || type == "linearcurve") {
    instance.shape = read_curve_file(properties, instance.to_world);
  } else if (type == "instance") {
    instance.shape = read_instanced_group(properties);
  } else {
    return false;
  }
  return true;
}

ShapeReader::ShapeId ShapeReader::read_mesh_file(Properties& properties) {
  const std::string_view type = properties.type();
  const std::filesystem::path file = properties.file("filename");
  MeshFileOptions options;
  options.face_normals = properties.boolean("face_normals", false);
  options.flip_normals = properties.boolean("flip_normals", false);
  options.flip_tex_coords = type != "serialized" && properties.boolean("flip_tex_coords", type == "obj");
  const int index = type == "serialized" ? properties.integer("shape_index", 0, 0, 1 << 30) : 0;
  if (properties.object().is_old) properties.ignore({"collapse", "max_smooth_angle", "srgb"});

  const std::string key = fmt::format("{}#{}#{}{}{}", file.string(), index, options.face_normals, options.flip_normals,
                                      options.flip_tex_coords);
  if (const auto known = meshes_.find(key); known != meshes_.end()) return known->second;
  scene::Mesh mesh = read_at(properties.find("filename")->where, [&] {
    if (type == "obj") return read_obj(file, options, report_.diagnostics());
    if (type == "ply") return read_ply(file, options, report_.diagnostics());
    return read_serialized(file, index, options, report_.diagnostics());
  });
  mesh.where = properties.where();
  const scene::Id<scene::Mesh> id = add(scene_.meshes, std::move(mesh));
  meshes_.emplace(key, id);
  return id;
}

/// Mitsuba turns the front of a mirrored sphere or cylinder to its inside.
void ShapeReader::read_sphere(Properties& properties, scene::Instance& instance) {
  const float radius = properties.number("radius", 1);
  if (!(radius > 0)) throw Problem(fmt::format("a sphere of radius {} is none", radius), properties.where());
  if (!keeps_spheres_round(instance.to_world))
    report_.repaired("a sphere's to_world makes it an ellipsoid; it stays a sphere", instance.where);
  instance.flip_normals = properties.boolean("flip_normals", false) != (instance.to_world.determinant() < 0);
  instance.to_world =
      instance.to_world * Transform::translation(properties.vector("center", Vec3(0))) * sphere_coordinates();
  instance.shape = add(scene_.spheres, scene::Sphere{instance.name, radius, instance.where});
}

void ShapeReader::read_cylinder(Properties& properties, scene::Instance& instance) {
  const float radius = properties.number("radius", 1);
  const Vec3 p0 = properties.vector("p0", Vec3(0)), p1 = properties.vector("p1", Vec3(0, 0, 1));
  const float height = length(p1 - p0);
  if (!(radius > 0) || !(height > 0))
    throw Problem("a cylinder needs a radius above zero and two different ends", properties.where());
  instance.flip_normals = properties.boolean("flip_normals", false) != (instance.to_world.determinant() < 0);
  const Frame frame = Frame::from_normal((p1 - p0) / height);
  instance.to_world = instance.to_world * Transform{frame.s * radius, frame.t * radius, frame.n * height, p0};
  instance.shape = add(scene_.cylinders, scene::Cylinder{instance.name, instance.where});
}

/// to_world moves the control points and leaves the radii as they are.
ShapeReader::ShapeId ShapeReader::read_curve_file(Properties& properties, Transform& to_world) {
  const auto basis = properties.type() == "linearcurve" ? scene::Curves::Basis::linear : scene::Curves::Basis::bspline;
  const std::filesystem::path file = properties.file("filename");
  scene::Curves curves = read_at(properties.find("filename")->where, [&] { return read_curves(file, basis); });
  curves.name = properties.name();
  curves.where = properties.where();
  for (Point3& p : curves.positions) p = to_world.point(p);
  to_world = {};
  return add(scene_.curves, std::move(curves));
}

ShapeReader::ShapeId ShapeReader::read_instanced_group(Properties& properties) {
  const Element* element = properties.object("shape");
  if (element == nullptr || element->type() != "shapegroup")
    throw Problem("an \"instance\" needs a <ref> to a <shape type=\"shapegroup\">", properties.where());
  return group(*element);
}

scene::Id<scene::Group> ShapeReader::group(const Element& element) {
  if (const auto known = groups_.find(&element); known != groups_.end()) return known->second;
  Properties properties(document_, element, report_);
  scene::Group group;
  group.name = properties.name();
  group.where = element.where;
  properties.ignore({"to_world"});
  for (const Element* shape : properties.objects("shape")) {
    try {
      add_to_group(group, *shape);
    } catch (const Problem& problem) {
      report_.error(problem);
    }
  }
  properties.reject_unread();
  const scene::Id<scene::Group> id = add(scene_.groups, std::move(group));
  groups_[&element] = id;
  return id;
}

void ShapeReader::add_to_group(scene::Group& group, const Element& element) {
  if (element.type() == "shapegroup")
    throw Problem("a group shows another group by an \"instance\" of it", element.where);
  Properties properties(document_, element, report_);
  std::optional<scene::Instance> instance = read(properties);
  if (!instance) return;
  read_material(properties, *instance, false);
  properties.reject_unread();
  group.instances.push_back(*std::move(instance));
}

void ShapeReader::read_media(Properties& properties, scene::Instance& instance) {
  instance.separates_media = properties.has("interior") || properties.has("exterior");
  instance.interior = media_.named(properties, "interior");
  instance.exterior = media_.named(properties, "exterior");
}

/// Without a <bsdf> a shape is grey; if it shines, black.
void ShapeReader::read_material(Properties& properties, scene::Instance& instance, bool may_shine) {
  if (std::holds_alternative<scene::Id<scene::Group>>(instance.shape)) {
    instance.material = materials_.default_material();
    return;
  }
  const Element *bsdf = properties.object("bsdf"), *emitter = properties.object("emitter");
  std::optional<scene::ColorInput> radiance;
  if (emitter != nullptr && !may_shine)
    report_.repaired("an emitter stands in a shapegroup, where nothing can shine; it is left out", emitter->where);
  else if (emitter != nullptr)
    radiance = read_area_emitter(document_, *emitter, textures_, report_);
  if (bsdf != nullptr)
    instance.material = materials_.material(document_, *bsdf, report_);
  else
    instance.material = emitter != nullptr ? materials_.black_material() : materials_.default_material();
  if (radiance) instance.material = materials_.shining(instance.material, *radiance);
}

}  // namespace etendue::mitsuba
