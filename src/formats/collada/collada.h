#pragma once

#include <filesystem>
#include <string>

#include "base/diagnostics.h"
#include "scene/scene.h"

/// The reader of COLLADA 1.4 (Khronos, "COLLADA – Digital Asset Schema Release 1.4.1") with the "CGL" profile of a
/// teaching renderer, which adds spheres, area lights and physically based materials as <technique profile="CGL">
/// inside <extra>.
///
/// What becomes what:
///   document       the file, parsed in place; ids, and the line and column of everything
///   sources        float arrays and accessors
///   primitives     triangles, polylist, polygons, trifans, tristrips → indexed triangles
///   geometry       <geometry> → meshes and spheres
///   materials      <material>, <effect>, <image>
///   lights_cameras <light>, <camera>
///   transforms     up axis, unit, and the transform elements of nodes
///   scene_reader   the visual scene's nodes → instances, lights, cameras in the y-up world in metres
///   one_light      a lamp that the file describes as area light and as emissive mesh becomes one
/// Only what the visual scene uses is read. Animations, physics, skins and morphs are not.
namespace etendue::collada {

/// Reads the COLLADA file at `path`. Repairs are counted warnings; errors are collected and thrown together as
/// Error(Failure::input).
scene::SceneDescription read_file(const std::filesystem::path& path, Diagnostics& diagnostics);

/// The same for a file's content in memory; `path` names it in messages, and its folder is where textures are looked
/// for.
scene::SceneDescription read_text(std::string text, const std::filesystem::path& path, Diagnostics& diagnostics);

}  // namespace etendue::collada
