#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "formats/mesh/mesh_file.h"
#include "scene/scene.h"

namespace etendue {

/// Reads a Wavefront OBJ file as one mesh, whatever objects, groups and materials it names. Polygons are cut into
/// triangles. Without `face_normals`, corners that have no normal get a smooth one: the mean over the faces at that
/// position, weighted by angle. Repairs become counted warnings; throws Error(Failure::input), "FILE:LINE: …", at what
/// cannot be repaired.
scene::Mesh read_obj(const std::filesystem::path& file, const MeshFileOptions& options, Diagnostics& diagnostics);

/// The same for a file's text; `name` stands for the file in messages.
scene::Mesh parse_obj(std::string_view text, const std::string& name, const MeshFileOptions& options,
                      Diagnostics& diagnostics);

}  // namespace etendue
