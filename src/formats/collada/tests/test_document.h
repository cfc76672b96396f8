#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "base/error.h"
#include "formats/collada/collada.h"

/// Small COLLADA documents for tests, and what reading them gives.
namespace etendue::collada::test {

/// A document with these libraries and these nodes in its visual scene.
inline std::string document(std::string_view libraries, std::string_view nodes,
                            std::string_view asset = "<up_axis>Y_UP</up_axis>") {
  return fmt::format(
      "<COLLADA version=\"1.4.1\"><asset>{}</asset>{}<library_visual_scenes><visual_scene "
      "id=\"scene\">{}</visual_scene>"
      "</library_visual_scenes><scene><instance_visual_scene url=\"#scene\"/></scene></COLLADA>",
      asset, libraries, nodes);
}

/// A <source> called `id` of vectors with `stride` components.
inline std::string source(std::string_view id, std::string_view numbers, int count, int stride = 3) {
  const std::string_view params = stride == 2 ? "<param name=\"S\"/><param name=\"T\"/>"
                                              : "<param name=\"X\"/><param name=\"Y\"/><param name=\"Z\"/>";
  return fmt::format(
      "<source id=\"{0}\"><float_array id=\"{0}-array\" count=\"{1}\">{2}</float_array><technique_common><accessor "
      "source=\"#{0}-array\" count=\"{3}\" stride=\"{4}\">{5}</accessor></technique_common></source>",
      id, count * stride, numbers, count, stride, params);
}

/// A geometry "g" whose mesh holds `content` after a POSITION source "p" and <vertices id="v">.
inline std::string geometry(std::string_view positions, int count, std::string_view content) {
  return fmt::format(
      "<library_geometries><geometry id=\"g\" name=\"shape\"><mesh>{}<vertices id=\"v\"><input semantic=\"POSITION\" "
      "source=\"#p\"/></vertices>{}</mesh></geometry></library_geometries>",
      source("p", positions, count), content);
}

inline constexpr std::string_view kVertexInput = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>";
inline constexpr std::string_view kPlaceGeometry =
    "<node id=\"n\" name=\"thing\"><instance_geometry url=\"#g\"/></node>";

/// The geometry "g": one triangle (0 0 0) (1 0 0) (0 1 0), bound to the symbol "m".
inline std::string triangle_geometry() {
  return geometry("0 0 0 1 0 0 0 1 0", 3,
                  fmt::format("<triangles material=\"m\" count=\"1\">{}<p>0 1 2</p></triangles>", kVertexInput));
}

/// All messages of a reading, formatted; of the error too if it failed.
struct Reading {
  scene::SceneDescription scene;
  std::string messages;
  bool failed = false;
};

inline Reading read(const std::string& text) {
  Reading result;
  Diagnostics diagnostics;
  try {
    result.scene = read_text(text, "test.dae", diagnostics);
  } catch (const Error&) {
    result.failed = true;
  }
  for (const Diagnostic& diagnostic : diagnostics.all()) result.messages += diagnostics.format(diagnostic) + "\n";
  return result;
}

}  // namespace etendue::collada::test
