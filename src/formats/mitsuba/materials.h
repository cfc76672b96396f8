#pragma once

#include <unordered_map>

#include "formats/mitsuba/textures.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// The scene's materials, each read when it is first used.
class MaterialLibrary {
 public:
  MaterialLibrary(scene::SceneDescription& scene, TextureLibrary& textures) : scene_(scene), textures_(textures) {}

  /// A <bsdf>. What is wrong with it is reported, once, and grey (0.5) stands in.
  scene::Id<scene::Material> material(const Document& document, const Element& element, Report& report);
  /// Grey (0.5) on the front, for what has no material.
  scene::Id<scene::Material> default_material();
  /// Reflects nothing, for lamps that have no material.
  scene::Id<scene::Material> black_material();
  /// A material like that one, which shines as well.
  scene::Id<scene::Material> shining(scene::Id<scene::Material> base, const scene::ColorInput& emission);

 private:
  using Reader = scene::Material (MaterialLibrary::*)(Properties&);
  static Reader reader_for(std::string_view type);

  scene::Id<scene::Material> add(scene::Material material);
  scene::Material read(const Document& document, const Element& element, Report& report);
  scene::Material diffuse(Properties& properties);
  scene::Material dielectric(Properties& properties);
  scene::Material thin_dielectric(Properties& properties);
  scene::Material rough_dielectric(Properties& properties);
  scene::Material conductor(Properties& properties);
  scene::Material rough_conductor(Properties& properties);
  scene::Material plastic(Properties& properties);
  scene::Material rough_plastic(Properties& properties);
  scene::Material principled(Properties& properties);
  scene::Material principled_thin(Properties& properties);
  scene::Material blend(Properties& properties);
  scene::Material mask(Properties& properties);
  scene::Material two_sided(Properties& properties);
  scene::Material bump_map(Properties& properties);
  scene::Material normal_map(Properties& properties);
  scene::Material null_surface(Properties& properties);

  scene::ConductorMaterial metal(Properties& properties);
  scene::PlasticMaterial plastic_base(Properties& properties);
  void read_roughness(Properties& properties, scene::FloatInput& alpha_u, scene::FloatInput& alpha_v);
  scene::Id<scene::Material> nested(Properties& properties);
  bool is_one_sided(scene::Id<scene::Material> id) const { return scene_.materials[id.index].one_sided; }

  scene::SceneDescription& scene_;
  TextureLibrary& textures_;
  std::unordered_map<const Element*, scene::Id<scene::Material>> known_;
  std::optional<scene::Id<scene::Material>> default_, black_;
};

}  // namespace etendue::mitsuba
