#pragma once

#include <string>

#include "scene/scene.h"

namespace etendue {

/// A mesh as a PLY file (Turk 1994), binary with the little end first, that read_ply reads as the same mesh. Triangles
/// are turned so that their winding agrees with their vertices' normals.
std::string ply_bytes(const scene::Mesh& mesh);

}  // namespace etendue
