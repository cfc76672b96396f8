#pragma once

#include <filesystem>
#include <optional>
#include <pugixml.hpp>
#include <unordered_map>
#include <vector>

#include "formats/collada/document.h"
#include "formats/report.h"
#include "scene/scene.h"

namespace etendue::collada {

/// The document's materials with their effects and images, each read when it is first used.
///
/// An effect's CGL technique decides if there is one: emission (which reflects nothing), mirror, glass (Schlick's
/// Fresnel), refraction, microfacet (Beckmann) or diffuse. Otherwise the phong, lambert, blinn or constant technique of
/// its profile_COMMON does: its diffuse colour or texture is a Lambertian reflectance, its emission a radiance. The
/// rest of it has no physical meaning and is ignored.
class MaterialLibrary {
 public:
  MaterialLibrary(const Document& document, Report& report) : document_(document), report_(report) {}

  /// A <material>. What is wrong with it is reported, once, and the default material stands in.
  scene::Id<scene::Material> material(pugi::xml_node element);
  /// Grey (0.5), for what has no material.
  scene::Id<scene::Material> default_material();

  const std::vector<scene::Material>& materials() const { return materials_; }
  /// All that was read; leaves nothing behind.
  std::vector<scene::Material> take_materials() { return std::move(materials_); }
  std::vector<scene::Texture> take_textures() { return std::move(textures_); }

 private:
  /// An effect as a material uses it.
  struct Effect {
    pugi::xml_node element, profile, instance;
  };

  scene::Id<scene::Material> add(scene::Material material);
  scene::Material read(pugi::xml_node element);
  scene::Material read_cgl(pugi::xml_node model);
  scene::Material read_common(const Effect& effect, pugi::xml_node model);

  scene::ColorInput diffuse(const Effect& effect, pugi::xml_node slot);
  Spectrum emission(const Effect& effect, pugi::xml_node slot);
  std::optional<scene::Id<scene::Texture>> texture(const Effect& effect, pugi::xml_node element);
  pugi::xml_node image_of(const Effect& effect, std::string_view name) const;
  pugi::xml_node parameter(const Effect& effect, std::string_view name) const;
  std::filesystem::path image_file(pugi::xml_node init_from);

  Spectrum color(pugi::xml_node element) const;
  Spectrum radiance(pugi::xml_node element);
  Spectrum reflectance(pugi::xml_node element);
  Spectrum tint(pugi::xml_node model, const char* name);
  float index_of_refraction(pugi::xml_node model) const;
  void warn_about_roughness(pugi::xml_node model);

  const Document& document_;
  Report& report_;
  std::vector<scene::Material> materials_;
  std::vector<scene::Texture> textures_;
  std::unordered_map<const void*, scene::Id<scene::Material>> by_element_;
  std::unordered_map<const void*, scene::Id<scene::Texture>> by_image_;
  std::optional<scene::Id<scene::Material>> default_;
};

}  // namespace etendue::collada
