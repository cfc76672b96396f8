#pragma once

#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "formats/mitsuba/materials.h"
#include "formats/mitsuba/media.h"
#include "formats/mitsuba/sensors.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// Reads <shape>s with what stands in them, and files and groups that many share only once.
class ShapeReader {
 public:
  ShapeReader(const Document& document, scene::SceneDescription& scene, TextureLibrary& textures,
              MaterialLibrary& materials, MediumLibrary& media, Report& report)
      : document_(document),
        scene_(scene),
        textures_(textures),
        materials_(materials),
        media_(media),
        report_(report) {}

  /// Places a shape in the scene; the sensor in it, if there is one. Throws Problem.
  std::optional<Sensor> place(const Element& element);

 private:
  using ShapeId = decltype(scene::Instance::shape);

  std::optional<scene::Instance> read(Properties& properties);
  bool read_geometry(Properties& properties, scene::Instance& instance);
  ShapeId read_mesh_file(Properties& properties);
  void read_sphere(Properties& properties, scene::Instance& instance);
  void read_cylinder(Properties& properties, scene::Instance& instance);
  ShapeId read_curve_file(Properties& properties, Transform& to_world);
  ShapeId read_instanced_group(Properties& properties);
  scene::Id<scene::Group> group(const Element& element);
  void add_to_group(scene::Group& group, const Element& element);

  void read_media(Properties& properties, scene::Instance& instance);
  void read_material(Properties& properties, scene::Instance& instance, bool may_shine);

  const Document& document_;
  scene::SceneDescription& scene_;
  TextureLibrary& textures_;
  MaterialLibrary& materials_;
  MediumLibrary& media_;
  Report& report_;
  std::map<std::string, scene::Id<scene::Mesh>> meshes_;  ///< under file and options
  std::unordered_map<const Element*, scene::Id<scene::Group>> groups_;
};

}  // namespace etendue::mitsuba
