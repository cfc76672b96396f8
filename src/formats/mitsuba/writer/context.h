#pragma once

#include <string_view>

#include "base/diagnostics.h"
#include "formats/mitsuba/writer/elements.h"
#include "formats/mitsuba/writer/side_files.h"
#include "scene/scene.h"

namespace etendue::mitsuba {

/// What all parts of the writer share.
struct WriterContext {
  const scene::SceneDescription& scene;
  SideFiles& files;
  Diagnostics& diagnostics;
  Ids ids = {};

  /// Tells what Mitsuba has no word for, and what stands in the scene instead; once, with a count.
  void written_instead(std::string_view message, SourceLocation where) { diagnostics.repaired(message, where); }
};

}  // namespace etendue::mitsuba
