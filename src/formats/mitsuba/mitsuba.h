#pragma once

#include <filesystem>
#include <string>

#include "base/diagnostics.h"
#include "formats/mitsuba/document.h"
#include "scene/scene.h"

/// The reader of Mitsuba's XML scenes, versions 2 and 3, as its RGB mode understands them (Jakob et al., "Mitsuba 3
/// renderer", 2022); the names of version 0.6 are brought to today's.
///
/// What becomes what:
///   document      the file with all that it includes: $names, <path>, <alias>, <ref>, and the place of everything
///   tags          which elements and attributes there are
///   properties    what an object says of itself, by name; what nobody asks for is an error
///   values        numbers and vectors in attributes
///   transforms    <transform>
///   spectra       <rgb>, <spectrum> → linear Rec. 709
///   textures, volumes, media, materials, emitters, shapes (primitives, curves), sensors (fov), integrators: the
///   elements scene_reader  all of them → SceneDescription
/// Files that shapes, textures and volumes name are read by formats/mesh, formats/volume_file and the image room.
namespace etendue::mitsuba {

/// Reads the Mitsuba scene at `path`. Repairs are counted warnings; errors are collected and thrown together as
/// Error(Failure::input).
scene::SceneDescription read_file(const std::filesystem::path& path, const Definitions& definitions,
                                  Diagnostics& diagnostics);

/// The same for a file's content in memory; `path` names it in messages, and other files are looked for in its folder.
scene::SceneDescription read_text(std::string text, const std::filesystem::path& path, const Definitions& definitions,
                                  Diagnostics& diagnostics);

}  // namespace etendue::mitsuba
