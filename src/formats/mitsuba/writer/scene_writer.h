#pragma once

#include <filesystem>

#include "base/diagnostics.h"
#include "scene/scene.h"

/// The writer of Mitsuba's XML scenes, version 3: what formats/mitsuba reads back as the same scene.
///
///   elements      what XML is made of: numbers, colours, transforms, ids
///   side_files    the meshes, volumes and pictures that stand beside the scene
///   textures, materials, media, shapes, lights (sky_pictures), camera: what of a scene is written where
///   scene_writer  all of them
namespace etendue::mitsuba {

/// Writes the description as the scene `path`, and what it needs beside it in the folder NAME_files. Pictures,
/// environment maps and OpenVDB files stay where they are and are referred to. What Mitsuba has no word for becomes a
/// counted warning that says what is written instead. Everything appears, or nothing: false if `stopped`, which may be
/// null, became true before. Throws Error(Failure::output), Error(Failure::usage) if a file that the scene refers to
/// would be overwritten.
bool write_file(const std::filesystem::path& path, const scene::SceneDescription& scene, Diagnostics& diagnostics,
                bool (*stopped)() = nullptr);

}  // namespace etendue::mitsuba
