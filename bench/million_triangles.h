#pragma once

#include <filesystem>

namespace etendue {

/// Writes a COLLADA file with one mesh of 2·side² triangles: a rippled sheet with normals.
void write_sheet(const std::filesystem::path& path, int side);

}  // namespace etendue
