#include "formats/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string>

#include "base/error.h"
#include "formats/collada/collada.h"
#include "formats/mitsuba/mitsuba.h"
#include "formats/mitsuba/writer/scene_writer.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;

scene::SceneDescription read_collada(const fs::path& path, const ReadOptions&, Diagnostics& diagnostics) {
  return collada::read_file(path, diagnostics);
}

scene::SceneDescription read_mitsuba(const fs::path& path, const ReadOptions& options, Diagnostics& diagnostics) {
  return mitsuba::read_file(path, options.definitions, diagnostics);
}

constexpr std::array<std::string_view, 1> kColladaExtensions = {".dae"}, kMitsubaExtensions = {".xml"};
constexpr SceneFormat kFormats[] = {
    {"COLLADA", kColladaExtensions, read_collada},
    {"Mitsuba", kMitsubaExtensions, read_mitsuba, mitsuba::write_file},
};
constexpr const SceneFormat& kCollada = kFormats[0];

[[noreturn]] void reject(const fs::path& path, const std::string& reason) {
  throw Error(Failure::input, fmt::format("{}: {}", path.string(), reason));
}

void require_content(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) reject(path, "there is no such file");
  if (error) reject(path, error.message());
  if (fs::is_directory(status)) reject(path, "this is a folder; name the scene file in it");
  if (!fs::is_regular_file(status)) reject(path, "this is not a regular file");
  if (!std::ifstream(path)) reject(path, "the file cannot be opened for reading; check its permissions");
  if (fs::file_size(path, error) == 0 || error) reject(path, "the file is empty");
}

std::string lower_case_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// Whether the file's first element is <COLLADA>.
bool looks_like_collada(const fs::path& path) {
  std::string head(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head.find("<COLLADA") != std::string::npos && head.find_first_not_of("\xef\xbb\xbf \t\r\n") == head.find('<');
}

/// What the file starts with counts before what it is called.
const SceneFormat& format_of(const fs::path& path) {
  if (looks_like_collada(path)) return kCollada;
  const std::string extension = lower_case_extension(path);
  std::string known;
  for (const SceneFormat& format : kFormats)
    for (const std::string_view candidate : format.extensions) {
      if (candidate == extension) return format;
      known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", candidate, format.name);
    }
  reject(path,
         fmt::format("scene files {} are not known; known are {}",
                     extension.empty() ? "without extension" : fmt::format("that end in \"{}\"", extension), known));
}

const SceneFormat& written_format_of(const fs::path& path) {
  const std::string extension = lower_case_extension(path);
  std::string known;
  for (const SceneFormat& format : kFormats)
    for (const std::string_view candidate : format.extensions) {
      if (format.write == nullptr) continue;
      if (candidate == extension) return format;
      known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", candidate, format.name);
    }
  throw Error(Failure::usage,
              fmt::format("{}: scenes are written as {}; choose a name that ends so", path.string(), known));
}

}  // namespace

std::span<const SceneFormat> scene_formats() {
  return kFormats;
}

scene::SceneDescription read_scene(const std::filesystem::path& path, Diagnostics& diagnostics,
                                   const ReadOptions& options) {
  require_content(path);
  return format_of(path).read(path, options, diagnostics);
}

void check_scene_writable(const std::filesystem::path& path) {
  written_format_of(path);
}

bool write_scene(const std::filesystem::path& path, const scene::SceneDescription& scene, Diagnostics& diagnostics,
                 StopQuery stopped) {
  return written_format_of(path).write(path, scene, diagnostics, stopped);
}

}  // namespace etendue
