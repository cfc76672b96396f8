#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "formats/mesh/mesh_file.h"
#include "scene/scene.h"

namespace etendue {

/// Reads a PLY file (Turk 1994; ascii, binary of either byte order). Polygons are cut into triangles. Vertices without
/// normals get smooth ones, unless `face_normals`. Texture coordinates: u v, s t or texture_u texture_v. Further
/// properties become attributes: red green blue (or r g b) "vertex_color" or "face_color"; NAME_0 NAME_1 NAME_2 (also
/// _x _y _z, _1 _2 _3) or a single NAME_0 "vertex_NAME" or "face_NAME"; NAME_r NAME_g NAME_b "…_NAME_color". Integers
/// are colours of 8 or more bits: they are scaled to [0, 1] and decoded from sRGB. Repairs become counted warnings;
/// throws Error(Failure::input) that names the file and the place.
scene::Mesh read_ply(const std::filesystem::path& file, const MeshFileOptions& options, Diagnostics& diagnostics);

/// The same for a file's bytes; `name` stands for the file in messages.
scene::Mesh parse_ply(std::string_view bytes, const std::string& name, const MeshFileOptions& options,
                      Diagnostics& diagnostics);

}  // namespace etendue
