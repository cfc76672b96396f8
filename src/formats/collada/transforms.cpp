#include "formats/collada/transforms.h"

#include <charconv>
#include <string_view>

#include "formats/collada/numbers.h"

namespace etendue::collada {
namespace {

Vec3 vec3_at(const std::vector<float>& v, std::size_t i) {
  return {v[i], v[i + 1], v[i + 2]};
}

/// Sixteen numbers, row by row.
Transform from_matrix(const std::vector<float>& m, Report& report, SourceLocation where) {
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    report.repaired("the last row of a <matrix> is not 0 0 0 1; it is ignored", where);
  return {{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}, {m[3], m[7], m[11]}};
}

Transform from_rotate(const std::vector<float>& r, Report& report, SourceLocation where) {
  if (length_squared(vec3_at(r, 0)) > 0) return Transform::rotation(vec3_at(r, 0), radians(r[3]));
  if (r[3] != 0) report.repaired("a <rotate> has no axis; it is ignored", where);
  return {};
}

Transform from_lookat(const std::vector<float>& v, Report& report, SourceLocation where) {
  const Point3 eye = vec3_at(v, 0), interest = vec3_at(v, 3);
  Vec3 up = vec3_at(v, 6);
  if (eye == interest) {
    report.repaired("a <lookat> looks at its own eye point; its direction is ignored", where);
    return Transform::translation(eye);
  }
  if (length_squared(up) == 0) {
    report.repaired("a <lookat> has no up direction; 0 1 0 is used", where);
    up = {0, 1, 0};
  }
  return Transform::look_at(eye, interest, up);
}

/// A shear along the axis `b` that turns the axis `a` by `angle` towards it (The RenderMan Interface 3.2, Skew).
Transform from_skew(const std::vector<float>& v, Report& report, SourceLocation where) {
  const float angle = radians(v[0]);
  const Vec3 a = vec3_at(v, 1), b = normalize(vec3_at(v, 4));
  const float along = dot(a, b);
  const Vec3 across_vector = a - b * along;
  const float across = length(across_vector);
  const float turned_across = across * std::cos(angle) - along * std::sin(angle);
  if (!(across > 0) || !(turned_across > 1e-6f * across)) {
    report.repaired("a <skew> by this angle about these axes does not exist; it is ignored", where);
    return {};
  }
  const Vec3 n = across_vector / across;
  const float shear = (across * std::sin(angle) + along * std::cos(angle)) / turned_across - along / across;
  return {Vec3(1, 0, 0) + b * (shear * n.x),
          Vec3(0, 1, 0) + b * (shear * n.y),
          Vec3(0, 0, 1) + b * (shear * n.z),
          {0, 0, 0}};
}

Transform up_axis_rotation(const Document& document, Report& report, pugi::xml_node up_axis) {
  const std::string_view name = trimmed_text(up_axis);
  if (name == "Z_UP") return {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, 0}};
  if (name == "X_UP") return {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}, {0, 0, 0}};
  if (up_axis && name != "Y_UP")
    report.warning("the up axis " + in_quotes(name) + " is none of X_UP, Y_UP and Z_UP; Y_UP is used",
                   document.locate(up_axis));
  return {};
}

float metres_per_unit(const Document& document, Report& report, pugi::xml_node unit) {
  const pugi::xml_attribute meter = unit.attribute("meter");
  if (!meter) return 1;
  const std::string_view text = meter.value();
  float size = 0;
  const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (status == std::errc() && stop == text.data() + text.size() && size > 0 && std::isfinite(size)) return size;
  report.warning("meter=" + in_quotes(text) + " is not a size above zero; 1 is used", document.locate(meter.value()));
  return 1;
}

}  // namespace

Transform file_to_world(const Document& document, Report& report) {
  const pugi::xml_node asset = document.root().child("asset");
  const float size = metres_per_unit(document, report, asset.child("unit"));
  return up_axis_rotation(document, report, asset.child("up_axis")) * Transform::scaling(Vec3(size));
}

Transform node_transform(const Document& document, Report& report, pugi::xml_node node) {
  Transform result;
  for (const pugi::xml_node element : node.children()) {
    const std::string_view kind = element.name();
    const SourceLocation where = document.locate(element);
    const auto numbers = [&](std::size_t count) { return read_numbers(document, element, count, count); };
    if (kind == "matrix") result = result * from_matrix(numbers(16), report, where);
    if (kind == "translate") result = result * Transform::translation(vec3_at(numbers(3), 0));
    if (kind == "rotate") result = result * from_rotate(numbers(4), report, where);
    if (kind == "scale") result = result * Transform::scaling(vec3_at(numbers(3), 0));
    if (kind == "lookat") result = result * from_lookat(numbers(9), report, where);
    if (kind == "skew") result = result * from_skew(numbers(7), report, where);
  }
  return result;
}

}  // namespace etendue::collada
