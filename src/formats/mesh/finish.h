#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "formats/mesh/mesh_file.h"
#include "scene/scene.h"

namespace etendue {

/// What every mesh file has in common once it is read: triangles that are not finite or have no area are left out,
/// texture coordinates made finite, normals unit, and `options` followed. Unless `face_normals`, a vertex whose normal
/// is missing (the whole vector, or zero) gets a smooth one; vertices of the same `smoothing_group` share it (empty:
/// each is its own). `name` stands for the file in messages.
scene::Mesh finish_mesh(scene::Mesh mesh, const std::vector<std::uint32_t>& smoothing_group,
                        const MeshFileOptions& options, const std::string& name, Diagnostics& diagnostics);

}  // namespace etendue
