#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "scene/scene.h"

namespace etendue {

/// What a user can say about how a file is to be read.
struct ReadOptions {
  std::map<std::string, std::string> definitions;  ///< values for the $names of a Mitsuba scene
};

/// Asked again and again while a scene is written: whether it is wanted no more.
using StopQuery = bool (*)();

/// One scene file format: what it is called, how it is recognised, who reads it, and who writes it.
struct SceneFormat {
  std::string_view name;
  std::span<const std::string_view> extensions;  ///< lower case, with the dot
  scene::SceneDescription (*read)(const std::filesystem::path&, const ReadOptions&, Diagnostics&);
  bool (*write)(const std::filesystem::path&, const scene::SceneDescription&, Diagnostics&,
                StopQuery) = nullptr;  ///< null: cannot be written
};

/// All formats there are.
std::span<const SceneFormat> scene_formats();

/// Reads a scene file in the format its extension names. Problems that can be repaired become counted warnings in
/// `diagnostics`; what cannot be is collected there and thrown together as Error(Failure::input) with file, line and
/// remedy.
scene::SceneDescription read_scene(const std::filesystem::path& path, Diagnostics& diagnostics,
                                   const ReadOptions& options = {});

/// Throws Error(Failure::usage) if there is no format that can be written for the file's extension.
void check_scene_writable(const std::filesystem::path& path);

/// Writes a scene file in the format its extension names, whole or not at all. What the format cannot express becomes
/// counted warnings that say what is written instead. False: it was stopped, and nothing was written. Throws
/// Error(Failure::usage) as check_scene_writable, Error(Failure::output).
bool write_scene(const std::filesystem::path& path, const scene::SceneDescription& scene, Diagnostics& diagnostics,
                 StopQuery stopped = nullptr);

}  // namespace etendue
