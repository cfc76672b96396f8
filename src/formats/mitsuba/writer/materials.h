#pragma once

#include <map>

#include "formats/mitsuba/writer/textures.h"

namespace etendue::mitsuba {

/// Writes materials, each when something first refers to it.
class MaterialWriter {
 public:
  MaterialWriter(WriterContext& context, TextureWriter& textures) : context_(context), textures_(textures) {}

  /// The id of the material's <bsdf>, which says nothing of its emission.
  const std::string& id(scene::Id<scene::Material> material);

  const pugi::xml_document& elements() const { return elements_; }

 private:
  struct Target;
  void write(const scene::DiffuseMaterial& m, const Target& target);
  void write(const scene::MirrorMaterial& m, const Target& target);
  void write(const scene::GlassMaterial& m, const Target& target);
  void write(const scene::RefractionMaterial& m, const Target& target);
  void write(const scene::ConductorMaterial& m, const Target& target);
  void write(const scene::NoReflection& m, const Target& target);
  void write(const scene::ThinGlassMaterial& m, const Target& target);
  void write(const scene::RoughGlassMaterial& m, const Target& target);
  void write(const scene::PlasticMaterial& m, const Target& target);
  void write(const scene::PrincipledMaterial& m, const Target& target);
  void write(const scene::PrincipledThinMaterial& m, const Target& target);
  void write(const scene::NullMaterial& m, const Target& target);
  void write(const scene::BlendMaterial& m, const Target& target);
  void write(const scene::MaskMaterial& m, const Target& target);
  void write(const scene::TwoSidedMaterial& m, const Target& target);
  void write(const scene::BumpMaterial& m, const Target& target);
  void write(const scene::NormalMapMaterial& m, const Target& target);
  void add_roughness(pugi::xml_node node, const scene::FloatInput& u, const scene::FloatInput& v, const Target& target);

  WriterContext& context_;
  TextureWriter& textures_;
  pugi::xml_document elements_;
  std::map<std::uint32_t, std::string> ids_;
};

}  // namespace etendue::mitsuba
