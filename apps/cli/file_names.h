#pragma once

#include <filesystem>
#include <vector>

namespace etendue {

/// Throws Error(Failure::usage) if one of the files to be written is also read, or named twice, in whatever spelling.
void check_distinct(const std::vector<std::filesystem::path>& read, const std::vector<std::filesystem::path>& written);

}  // namespace etendue
