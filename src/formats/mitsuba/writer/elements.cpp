#include "formats/mitsuba/writer/elements.h"

#include <fmt/format.h>

#include <cctype>

namespace etendue::mitsuba {
namespace {

/// The shortest text that reads as the same float; zero has no sign.
std::string digits(float value) {
  return fmt::format("{}", value + 0.0f);
}

std::string digits(const Vec3& v) {
  return fmt::format("{} {} {}", digits(v.x), digits(v.y), digits(v.z));
}

/// A dollar would stand for the value of a name.
std::string without_names(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '$') result += '\\';
    result += c;
  }
  return result;
}

pugi::xml_node add_value(pugi::xml_node parent, const char* tag, const std::string& name, const std::string& value) {
  pugi::xml_node node = parent.append_child(tag);
  node.append_attribute("name") = name.c_str();
  node.append_attribute("value") = value.c_str();
  return node;
}

bool is_identity(const Transform& t) {
  const Transform none;
  return t.x == none.x && t.y == none.y && t.z == none.z && t.origin == none.origin;
}

}  // namespace

pugi::xml_node add_object(pugi::xml_node parent, const char* tag, const std::string& type, const std::string& id) {
  pugi::xml_node node = parent.append_child(tag);
  node.append_attribute("type") = type.c_str();
  if (!id.empty()) node.append_attribute("id") = id.c_str();
  return node;
}

void add_reference(pugi::xml_node parent, const std::string& name, const std::string& id) {
  pugi::xml_node node = parent.append_child("ref");
  if (!name.empty()) node.append_attribute("name") = name.c_str();
  node.append_attribute("id") = id.c_str();
}

void add_number(pugi::xml_node parent, const std::string& name, float value) {
  add_value(parent, "float", name, digits(value));
}

void add_integer(pugi::xml_node parent, const std::string& name, int value) {
  add_value(parent, "integer", name, fmt::format("{}", value));
}

void add_flag(pugi::xml_node parent, const std::string& name, bool value, bool missing) {
  if (value != missing) add_value(parent, "boolean", name, value ? "true" : "false");
}

void add_text(pugi::xml_node parent, const std::string& name, const std::string& value) {
  add_value(parent, "string", name, without_names(value));
}

void add_color(pugi::xml_node parent, const std::string& name, const Spectrum& value) {
  add_value(parent, "rgb", name, digits(Vec3(value.r, value.g, value.b)));
}

void add_reflectance(pugi::xml_node parent, const std::string& name, const Spectrum& value) {
  if (value.max() <= 1) return add_color(parent, name, value);
  pugi::xml_node node = add_object(parent, "spectrum", "srgb");
  node.append_attribute("name") = name.c_str();
  add_color(node, "color", value);
  add_flag(node, "unbounded", true);
}

void add_point(pugi::xml_node parent, const std::string& name, const Point3& value) {
  pugi::xml_node node = parent.append_child("point");
  node.append_attribute("name") = name.c_str();
  node.append_attribute("x") = digits(value.x).c_str();
  node.append_attribute("y") = digits(value.y).c_str();
  node.append_attribute("z") = digits(value.z).c_str();
}

void add_transform(pugi::xml_node parent, const std::string& name, const Transform& value) {
  if (is_identity(value)) return;
  pugi::xml_node node = parent.append_child("transform");
  node.append_attribute("name") = name.c_str();
  std::string rows;
  for (int i = 0; i < 3; ++i)
    rows += fmt::format("{} {}  ", digits(Vec3(value.x[i], value.y[i], value.z[i])), digits(value.origin[i]));
  node.append_child("matrix").append_attribute("value") = (rows + "0 0 0 1").c_str();
}

std::string Ids::unique(std::string_view name, std::string_view kind) {
  std::string base;
  for (const char c : name) base += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ? c : '_';
  if (base.empty() || base.front() == '_') base.insert(0, kind);  // what begins with "_" is Mitsuba's own
  std::string id = base;
  for (int& last = last_.try_emplace(base, 1).first->second; !taken_.insert(id).second;)
    id = fmt::format("{}-{}", base, ++last);
  return id;
}

std::string Ids::telling(std::string_view name, std::string_view type) {
  return name.empty() || name == type ? std::string() : unique(name, type);
}

}  // namespace etendue::mitsuba
