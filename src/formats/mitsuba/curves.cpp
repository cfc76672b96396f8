#include "formats/mitsuba/curves.h"

#include <fmt/format.h>

#include <cmath>

#include "formats/file_bytes.h"
#include "formats/text_cursor.h"

namespace etendue::mitsuba {
namespace {

float next_number(TextCursor& cursor) {
  const std::optional<double> number = cursor.to_word() ? cursor.number() : std::nullopt;
  if (!number || !std::isfinite(to_float(*number))) cursor.reject("a control point is four numbers: x y z radius");
  return to_float(*number);
}

/// Divides the points from `first` on into segments of `points_each` in a row.
void end_curve(scene::Curves& curves, std::size_t first, std::size_t points_each, const TextCursor& cursor) {
  const std::size_t count = curves.positions.size() - first;
  if (count == 0) return;
  if (count < points_each)
    cursor.reject(fmt::format("the curve that ends here has {} control points; it needs {}", count, points_each));
  for (std::size_t i = 0; i + points_each <= count; ++i)
    curves.segments.push_back(static_cast<std::uint32_t>(first + i));
}

}  // namespace

scene::Curves parse_curves(std::string_view text, const std::string& name, scene::Curves::Basis basis) {
  const std::size_t points_each = basis == scene::Curves::Basis::linear ? 2 : 4;
  TextCursor cursor(text, name);
  scene::Curves curves;
  curves.basis = basis;
  std::size_t first = 0;
  while (cursor.left() > 0) {
    if (cursor.to_word()) {
      const float x = next_number(cursor), y = next_number(cursor), z = next_number(cursor);
      curves.positions.emplace_back(x, y, z);
      curves.radii.push_back(next_number(cursor));
      if (curves.radii.back() < 0) cursor.reject("a radius is below zero");
    } else {
      end_curve(curves, first, points_each, cursor);
      first = curves.positions.size();
    }
    cursor.to_next_line();
  }
  end_curve(curves, first, points_each, cursor);
  if (curves.positions.empty()) cursor.reject("the file holds no control points");
  return curves;
}

scene::Curves read_curves(const std::filesystem::path& file, scene::Curves::Basis basis) {
  return parse_curves(read_file_bytes(file), file.string(), basis);
}

}  // namespace etendue::mitsuba
