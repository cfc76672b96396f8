#pragma once

#include <optional>
#include <unordered_map>

#include "formats/mitsuba/volumes.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// Participating media, each read when it is first used.
class MediumLibrary {
 public:
  MediumLibrary(scene::SceneDescription& scene, VolumeLibrary& volumes) : scene_(scene), volumes_(volumes) {}

  /// The medium of that name in an object ("interior", "exterior"), or, without a name, the only one there.
  std::optional<scene::Id<scene::Medium>> named(Properties& properties, std::string_view name);
  std::optional<scene::Id<scene::Medium>> only(Properties& properties);

 private:
  std::optional<scene::Id<scene::Medium>> medium(const Document& document, const Element& element, Report& report);
  std::optional<scene::Medium> read(const Document& document, const Element& element, Report& report);

  scene::SceneDescription& scene_;
  VolumeLibrary& volumes_;
  std::unordered_map<const Element*, std::optional<scene::Id<scene::Medium>>> known_;
};

}  // namespace etendue::mitsuba
