#include "formats/mitsuba/mitsuba.h"

#include <fmt/format.h>

#include "formats/file_bytes.h"
#include "formats/mitsuba/scene_reader.h"

namespace etendue::mitsuba {

scene::SceneDescription read_file(const std::filesystem::path& path, const Definitions& definitions,
                                  Diagnostics& diagnostics) {
  return read_text(read_file_bytes(path), path, definitions, diagnostics);
}

scene::SceneDescription read_text(std::string text, const std::filesystem::path& path, const Definitions& definitions,
                                  Diagnostics& diagnostics) {
  Report report(diagnostics);
  scene::SceneDescription scene;
  try {
    const Document document(std::move(text), path, definitions, diagnostics, report);
    diagnostics.throw_if_errors();  // what is missing now would only lead to further errors
    scene = read_scene(document, report);
    scene.format = fmt::format("Mitsuba {}", std::string_view(document.version()).substr(0, 16));
  } catch (const Problem& problem) {
    report.error(problem);
  }
  diagnostics.throw_if_errors();
  scene.file = path;
  return scene;
}

}  // namespace etendue::mitsuba
