#include "formats/mitsuba/fov.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "formats/mitsuba/values.h"

namespace etendue::mitsuba {
namespace {

enum class Axis { x, y, diagonal };

Axis read_axis(Properties& properties, float aspect) {
  switch (properties.choice("fov_axis", {"x", "y", "diagonal", "smaller", "larger"})) {
    case 1:
      return Axis::y;
    case 2:
      return Axis::diagonal;
    case 3:
      return aspect > 1 ? Axis::y : Axis::x;
    case 4:
      return aspect > 1 ? Axis::x : Axis::y;
    default:
      return Axis::x;
  }
}

/// "50mm" or "50".
double read_millimetres(Properties& properties) {
  const Element* element = properties.find("focal_length");
  if (element == nullptr) return 50;
  if (element->tag != "string") return properties.number("focal_length", 50, 1e-3f, 1e9f);
  const Attribute& value = required(*element, "value");
  std::string_view text = value.value;
  if (text.ends_with("mm")) text.remove_suffix(2);
  while (text.ends_with(' ')) text.remove_suffix(1);
  const float length = to_number(text, value);
  if (!(length > 0)) throw Problem("a focal length needs to be above zero", value.where);
  return length;
}

/// Tangent of half the angle along x, from that of half the angle along an axis.
double along_x(double tangent, Axis axis, double aspect) {
  if (axis == Axis::y) return tangent * aspect;
  return axis == Axis::diagonal ? tangent / std::sqrt(1 + 1 / (aspect * aspect)) : tangent;
}

}  // namespace

float read_horizontal_fov(Properties& properties, float aspect) {
  if (properties.has("fov") && properties.has("focal_length"))
    throw Problem("\"fov\" and \"focal_length\" say the same; one of them is enough", properties.where());
  const Axis axis = read_axis(properties, aspect);
  if (!properties.has("fov")) {
    const double film_diagonal = std::hypot(36.0, 24.0);
    const double tangent = film_diagonal / (2 * read_millimetres(properties));
    return static_cast<float>(2 * std::atan(along_x(tangent, Axis::diagonal, aspect)) * 180 / std::numbers::pi);
  }
  const float fov = properties.number("fov", 90);
  if (!(fov > 0 && fov < 180))
    throw Problem(fmt::format("the field of view {} is not between 0 and 180 degrees", fov),
                  properties.find("fov")->where);
  if (axis == Axis::x) return fov;
  const double tangent = std::tan(0.5 * fov * std::numbers::pi / 180);
  return static_cast<float>(2 * std::atan(along_x(tangent, axis, aspect)) * 180 / std::numbers::pi);
}

}  // namespace etendue::mitsuba
