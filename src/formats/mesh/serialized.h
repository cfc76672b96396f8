#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "formats/mesh/mesh_file.h"
#include "scene/scene.h"

namespace etendue {

/// Reads one of the meshes of a Mitsuba "serialized" file (versions 3 and 4), the first has `shape_index` 0. Vertices
/// without normals get smooth ones, unless `face_normals`. Repairs become counted warnings; throws
/// Error(Failure::input) that names the file.
scene::Mesh read_serialized(const std::filesystem::path& file, int shape_index, const MeshFileOptions& options,
                            Diagnostics& diagnostics);

/// The same for a file's bytes; `name` stands for the file in messages.
scene::Mesh parse_serialized(std::string_view bytes, const std::string& name, int shape_index,
                             const MeshFileOptions& options, Diagnostics& diagnostics);

}  // namespace etendue
