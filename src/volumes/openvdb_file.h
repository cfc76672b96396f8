#pragma once

#include <filesystem>
#include <string>

#include "volumes/nvdb_file.h"

namespace etendue {

/// Whether a file begins as OpenVDB's (.vdb) do. Throws Error(Failure::input) if it cannot be opened.
bool is_openvdb_file(const std::filesystem::path& file);

/// The grid of that name (empty: the first that can be read) of an OpenVDB file as a NanoVDB grid, sparse as it was;
/// double precision, halves and 32-bit integers become floats. Throws Error(Failure::input) for files that are torn, or
/// whose headers lie. Sizes among packed voxels are OpenVDB's to check, and it does not check all: there a damaged file
/// can still end the program.
NvdbBytes read_openvdb_file(const std::filesystem::path& file, const std::string& grid);

}  // namespace etendue
