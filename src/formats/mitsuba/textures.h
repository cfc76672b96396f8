#pragma once

#include <map>
#include <optional>
#include <utility>

#include "formats/mitsuba/spectra.h"
#include "formats/mitsuba/volumes.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// Colours, numbers and the textures that stand for them, each read when it is first used.
class TextureLibrary {
 public:
  TextureLibrary(scene::SceneDescription& scene, VolumeLibrary& volumes) : scene_(scene), volumes_(volumes) {}

  /// What a texture is asked for: colours or numbers of surfaces, or the picture that a lamp throws, whose v points up.
  enum class Use { color, number, slide };

  /// A property that is a colour or a texture.
  scene::ColorInput color(Properties& properties, std::string_view name, const Spectrum& missing, SpectrumRole role,
                          Use use = Use::color);
  scene::ColorInput reflectance(Properties& properties, std::string_view name, float missing) {
    return color(properties, name, Spectrum(missing), SpectrumRole::reflectance);
  }
  /// A property that is a number or a texture. Of a colour the luminance counts.
  scene::FloatInput number(Properties& properties, std::string_view name, float missing);
  /// A property that has one colour everywhere. A texture is left out with a warning.
  Spectrum constant(Properties& properties, std::string_view name, const Spectrum& missing, SpectrumRole role);
  /// A <texture>; nothing, with a warning, if it is of an unknown type.
  std::optional<scene::Id<scene::Texture>> texture(const Document& document, const Element& element, Use use,
                                                   Report& report);

  const scene::SceneDescription& scene() const { return scene_; }

 private:
  std::optional<scene::Texture> read(const Document& document, const Element& element, Use use, Report& report);
  scene::Texture read_bitmap(Properties& properties);
  scene::Texture read_checkerboard(Properties& properties, Use use);
  scene::Texture read_mesh_attribute(Properties& properties);
  std::optional<scene::Texture> read_volume(Properties& properties);

  scene::SceneDescription& scene_;
  VolumeLibrary& volumes_;
  std::map<std::pair<const Element*, Use>, std::optional<scene::Id<scene::Texture>>> known_;
};

}  // namespace etendue::mitsuba
