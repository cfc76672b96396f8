#pragma once

#include <map>

#include "formats/mitsuba/writer/camera.h"
#include "formats/mitsuba/writer/materials.h"
#include "formats/mitsuba/writer/media.h"

namespace etendue::mitsuba {

/// Writes instances: meshes as files, each once; groups when something first refers to them.
class ShapeWriter {
 public:
  ShapeWriter(WriterContext& context, TextureWriter& textures, MaterialWriter& materials, MediumWriter& media)
      : context_(context), textures_(textures), materials_(materials), media_(media) {}

  /// Adds the instance to the scene; with the camera that measures it, if one is given.
  void add(pugi::xml_node parent, const scene::Instance& instance, const scene::Camera* camera);
  /// A lamp that is a surface.
  void add(pugi::xml_node parent, const scene::Light& light, const scene::RectangleLight& rectangle);

  const pugi::xml_document& groups() const { return groups_; }

 private:
  pugi::xml_node add_geometry(pugi::xml_node parent, const scene::Instance& instance);
  pugi::xml_node add_mesh(pugi::xml_node parent, const scene::Instance& instance, scene::Id<scene::Mesh> mesh);
  void add_material(pugi::xml_node node, const scene::Instance& instance, bool may_shine);
  const std::string& mesh_file(scene::Id<scene::Mesh> mesh);
  const std::string& curve_file(scene::Id<scene::Curves> curves);
  const std::string& group_id(scene::Id<scene::Group> group);

  WriterContext& context_;
  TextureWriter& textures_;
  MaterialWriter& materials_;
  MediumWriter& media_;
  pugi::xml_document groups_;
  std::map<std::uint32_t, std::string> mesh_files_, curve_files_, group_ids_;
};

}  // namespace etendue::mitsuba
