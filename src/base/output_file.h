#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace etendue {

/// Puts `bytes` into the file `path`, whole or not at all: written under a temporary name (".NAME.partial-…") in the
/// same folder, flushed to the disk, and renamed. Whatever fails, nothing of the temporary file stays and an older file
/// of that name keeps its content. Throws Error(Failure::output) with file, reason and remedy.
void write_whole_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Throws what write_whole_file would throw for a missing folder, one that cannot be written to, or a name that is
/// taken by something other than a file. Leaves nothing behind.
void check_file_writable(const std::filesystem::path& path);

}  // namespace etendue
