#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "scene/scene.h"

namespace etendue {

/// One scene file format: what it is called, how it is recognised, who reads it.
struct SceneFormat {
  std::string_view name;
  std::span<const std::string_view> extensions;  ///< lower case, with the dot
  scene::SceneDescription (*read)(const std::filesystem::path&, Diagnostics&);
};

/// All formats there are.
std::span<const SceneFormat> scene_formats();

/// Reads a scene file in the format its extension names. Problems that can be repaired become counted warnings in `diagnostics`;
/// what cannot be is collected there and thrown together as Error(Failure::input) with file, line and remedy.
scene::SceneDescription read_scene(const std::filesystem::path& path, Diagnostics& diagnostics);

}  // namespace etendue
