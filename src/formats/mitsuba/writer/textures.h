#pragma once

#include <map>

#include "formats/mitsuba/textures.h"
#include "formats/mitsuba/writer/context.h"

namespace etendue::mitsuba {

/// Writes textures and volumes, each when something first refers to it.
class TextureWriter {
 public:
  using Use = TextureLibrary::Use;

  explicit TextureWriter(WriterContext& context) : context_(context) {}

  /// Of a surface.
  void add(pugi::xml_node parent, const std::string& name, const scene::ColorInput& input);
  void add_emission(pugi::xml_node parent, const std::string& name, const scene::ColorInput& input, Use use);
  void add(pugi::xml_node parent, const std::string& name, const scene::FloatInput& input);
  void add(pugi::xml_node parent, const std::string& name, const scene::VolumeInput& input);
  void add(pugi::xml_node parent, const std::string& name, scene::Id<scene::Texture> texture, Use use);

  const pugi::xml_document& elements() const { return elements_; }

 private:
  const std::string& id(scene::Id<scene::Texture> texture, Use use);
  const std::string& id(scene::Id<scene::Volume> volume);
  void write(const scene::BitmapTexture& bitmap, const scene::Texture& texture, Use use, const std::string& id);
  void write(const scene::CheckerboardTexture& board, const scene::Texture& texture, Use use, const std::string& id);
  void write(const scene::MeshAttributeTexture& attribute, const scene::Texture& texture, Use use,
             const std::string& id);
  void write(const scene::VolumeTexture& volume, const scene::Texture& texture, Use use, const std::string& id);
  void write(const scene::GridVolume& grid, const scene::Volume& volume, pugi::xml_node node);
  void write(const scene::VdbVolume& file, const scene::Volume& volume, pugi::xml_node node);

  WriterContext& context_;
  pugi::xml_document elements_;
  std::map<std::pair<std::uint32_t, Use>, std::string> textures_;
  std::map<std::uint32_t, std::string> volumes_;
};

}  // namespace etendue::mitsuba
