#include "million_triangles.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>

namespace etendue {

void write_sheet(const std::filesystem::path& path, int side) {
  std::string out =
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">)"
      R"(<asset><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="sheet"><mesh>)";
  const int points = (side + 1) * (side + 1);
  const auto source = [&](const char* name, auto&& value) {
    fmt::format_to(std::back_inserter(out), R"(<source id="{0}"><float_array id="{0}-array" count="{1}">)", name,
                   3 * points);
    for (int y = 0; y <= side; ++y)
      for (int x = 0; x <= side; ++x) value(static_cast<double>(x) / side, static_cast<double>(y) / side);
    fmt::format_to(std::back_inserter(out),
                   R"(</float_array><technique_common><accessor source="#{0}-array" count="{1}" stride="3">)"
                   R"(<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>)"
                   R"(</accessor></technique_common></source>)",
                   name, points);
  };
  source("positions", [&](double x, double y) {
    fmt::format_to(std::back_inserter(out), "{:.6f} {:.6f} {:.6f} ", x, 0.05 * std::sin(20 * x) * std::cos(20 * y), y);
  });
  source("normals", [&](double x, double y) {
    const double dx = std::cos(20 * x) * std::cos(20 * y), dy = -std::sin(20 * x) * std::sin(20 * y);
    const double scale = 1 / std::sqrt(1 + dx * dx + dy * dy);
    fmt::format_to(std::back_inserter(out), "{:.5f} {:.5f} {:.5f} ", -dx * scale, scale, -dy * scale);
  });
  fmt::format_to(std::back_inserter(out),
                 R"(<vertices id="vertices"><input semantic="POSITION" source="#positions"/></vertices>)"
                 R"(<triangles count="{}"><input semantic="VERTEX" source="#vertices" offset="0"/>)"
                 R"(<input semantic="NORMAL" source="#normals" offset="1"/><p>)",
                 2 * side * side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int a = y * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
      fmt::format_to(std::back_inserter(out), "{0} {0} {1} {1} {2} {2} {2} {2} {1} {1} {3} {3} ", a, c, b, d);
    }
  out += R"(</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="scene">)"
         R"(<node><instance_geometry url="#sheet"/></node></visual_scene></library_visual_scenes>)"
         R"(<scene><instance_visual_scene url="#scene"/></scene></COLLADA>)";
  std::ofstream(path) << out;
}

}  // namespace etendue
