#include "formats/collada/collada.h"

#include <fmt/format.h>

#include <fstream>

#include "base/error.h"
#include "formats/collada/document.h"
#include "formats/collada/scene_reader.h"
#include "formats/report.h"

namespace etendue::collada {
namespace {

std::string read_whole(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(static_cast<std::size_t>(std::filesystem::file_size(path)), '\0');
  if (!file.read(text.data(), static_cast<std::streamsize>(text.size())))
    throw Error(Failure::input, fmt::format("{}: the file cannot be read", path.string()));
  return text;
}

std::string read_version(const Document& document, Report& report) {
  const pugi::xml_attribute version = document.root().attribute("version");
  const std::string_view text = version.value();
  if (!text.starts_with("1.4"))
    report.warning(fmt::format("COLLADA version {} is not 1.4; it is read as if it were", in_quotes(text)),
                   document.locate(document.root()));
  return version ? fmt::format("COLLADA {}", text.substr(0, 16)) : "COLLADA";
}

}  // namespace

scene::SceneDescription read_file(const std::filesystem::path& path, Diagnostics& diagnostics) {
  return read_text(read_whole(path), path, diagnostics);
}

scene::SceneDescription read_text(std::string text, const std::filesystem::path& path, Diagnostics& diagnostics) {
  Report report(diagnostics);
  scene::SceneDescription scene;
  try {
    const Document document(std::move(text), path, diagnostics.add_file(path));
    const std::string version = read_version(document, report);
    scene = read_scene(document, report);
    scene.format = version;
  } catch (const Problem& problem) {
    report.error(problem);
  }
  diagnostics.throw_if_errors();
  scene.file = path;
  return scene;
}

}  // namespace etendue::collada
