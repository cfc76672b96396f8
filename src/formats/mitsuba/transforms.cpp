#include "formats/mitsuba/transforms.h"

#include <fmt/format.h>

#include "formats/mitsuba/values.h"
#include "math/frame.h"

namespace etendue::mitsuba {
namespace {

Transform from_rotate(const Element& element) {
  const Vec3 axis = vector_of(element, 0);
  if (!(length_squared(axis) > 0))
    throw Problem("<rotate> needs an axis, as in <rotate y=\"1\" angle=\"90\"/>", element.where);
  const Attribute& angle = required(element, "angle");
  const std::vector<float> numbers = numbers_of(angle);
  if (numbers.size() != 1)
    throw Problem(fmt::format("angle={} of <rotate> is not a number", in_quotes(angle.value)), angle.where);
  return Transform::rotation(axis, radians(numbers.front()));
}

/// Four by four numbers, row by row, or three by three.
Transform from_matrix(const Element& element, Report& report) {
  const Attribute& value = required(element, "value");
  const std::vector<float> m = numbers_of(value);
  if (m.size() == 9) return {{m[0], m[3], m[6]}, {m[1], m[4], m[7]}, {m[2], m[5], m[8]}, {0, 0, 0}};
  if (m.size() != 16) throw Problem(fmt::format("<matrix> has {} numbers; it needs 16 or 9", m.size()), value.where);
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    report.repaired("the last row of a <matrix> is not 0 0 0 1; it is ignored", value.where);
  return {{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}, {m[3], m[7], m[11]}};
}

Vec3 three_numbers(const Attribute& attribute) {
  const std::vector<float> v = numbers_of(attribute);
  if (v.size() != 3)
    throw Problem(
        fmt::format("{}={} has {} numbers; it needs three", attribute.name, in_quotes(attribute.value), v.size()),
        attribute.where);
  return {v[0], v[1], v[2]};
}

Transform from_lookat(const Element& element) {
  const Vec3 eye = three_numbers(required(element, "origin")), target = three_numbers(required(element, "target"));
  if (eye == target) throw Problem("a <lookat> looks at its own origin", element.where);
  const Attribute* given = element.find("up");
  Vec3 up = given == nullptr || given->value.empty() ? Vec3(0) : three_numbers(*given);
  if (length_squared(up) == 0) up = any_up(normalize(target - eye));
  const Transform frame = look_at(eye, target, up);
  if (!is_finite(frame)) throw Problem("a <lookat> looks along its own \"up\"", element.where);
  return frame;
}

Transform read_step(const Element& element, Report& report) {
  if (element.tag == "translate") return Transform::translation(vector_of(element, 0));
  if (element.tag == "scale") return Transform::scaling(vector_of(element, 1));
  if (element.tag == "rotate") return from_rotate(element);
  if (element.tag == "matrix") return from_matrix(element, report);
  return from_lookat(element);
}

}  // namespace

Transform read_transform(const Element& element, Report& report) {
  Transform result;
  for (const Element* step : element.children) result = read_step(*step, report) * result;
  if (!is_finite(result)) throw Problem("this <transform> is too large for numbers", element.where);
  return result;
}

Transform look_at(const Point3& eye, const Point3& target, const Vec3& up) {
  const Vec3 forward = normalize(target - eye);
  const Vec3 left = normalize(cross(up, forward));
  return {left, cross(forward, left), forward, eye};
}

Vec3 any_up(const Vec3& direction) {
  return Frame::from_normal(direction).s;
}

Transform facing_backwards(const Transform& to_world) {
  return {-to_world.x, to_world.y, -to_world.z, to_world.origin};
}

bool is_finite(const Transform& t) {
  return etendue::is_finite(t.x) && etendue::is_finite(t.y) && etendue::is_finite(t.z) && etendue::is_finite(t.origin);
}

}  // namespace etendue::mitsuba
