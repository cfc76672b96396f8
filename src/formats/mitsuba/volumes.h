#pragma once

#include <unordered_map>

#include "formats/mitsuba/properties.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// Values that vary in space, each read when it is first used.
class VolumeLibrary {
 public:
  explicit VolumeLibrary(scene::SceneDescription& scene) : scene_(scene) {}

  /// A property that is a colour, a number or a <volume>.
  scene::VolumeInput input(Properties& properties, std::string_view name, float missing);
  /// The same for the extinction of a heterogeneous medium, which ends where its volume does: a constant becomes a
  /// volume of one cell that fills the unit cube under the volume's to_world.
  scene::VolumeInput extinction(Properties& properties, std::string_view name, float missing);
  /// A <volume>. Throws Problem.
  scene::VolumeInput volume(const Document& document, const Element& element, Report& report);

 private:
  scene::VolumeInput read(const Document& document, const Element& element, Report& report);
  scene::VolumeInput read_grid(Properties& properties);

  scene::SceneDescription& scene_;
  std::unordered_map<const Element*, scene::VolumeInput> known_;
};

}  // namespace etendue::mitsuba
