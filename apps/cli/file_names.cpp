#include "file_names.h"

#include <fmt/format.h>

#include <set>

#include "base/error.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;

/// One name for a file, however it is spelled and through whatever links.
fs::path resolved(const fs::path& file) {
  std::error_code failure;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(file), failure);
  return failure ? file : canonical;
}

}  // namespace

void check_distinct(const std::vector<fs::path>& read, const std::vector<fs::path>& written) {
  std::set<fs::path> inputs, outputs;
  for (const fs::path& file : read) inputs.insert(resolved(file));
  for (const fs::path& file : written) {
    if (inputs.contains(resolved(file)))
      throw Error(Failure::usage,
                  fmt::format("{} would be overwritten, but it is an input; choose another name", file.string()));
    if (!outputs.insert(resolved(file)).second)
      throw Error(Failure::usage, fmt::format("{} would be written twice; choose different names", file.string()));
  }
}

}  // namespace etendue
