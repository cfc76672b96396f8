#pragma once

#include <map>

#include "formats/mitsuba/writer/textures.h"

namespace etendue::mitsuba {

/// Writes participating media, each when something first refers to it.
class MediumWriter {
 public:
  MediumWriter(WriterContext& context, TextureWriter& textures) : context_(context), textures_(textures) {}

  /// Nothing for a vacuum.
  void add(pugi::xml_node parent, const std::string& name, const std::optional<scene::Id<scene::Medium>>& medium);

  const pugi::xml_document& elements() const { return elements_; }

 private:
  const std::string& id(scene::Id<scene::Medium> medium);

  WriterContext& context_;
  TextureWriter& textures_;
  pugi::xml_document elements_;
  std::map<std::uint32_t, std::string> ids_;
};

}  // namespace etendue::mitsuba
