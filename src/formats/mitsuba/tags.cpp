#include "formats/mitsuba/tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <span>

namespace etendue::mitsuba {
namespace {

/// What may stand in a tag; attributes are parted by spaces.
struct TagRule {
  std::string_view tag, required, optional;
};

constexpr std::string_view kObjects[] = {"bsdf",    "emitter", "film",   "integrator", "medium",  "phase", "rfilter",
                                         "sampler", "scene",   "sensor", "shape",      "texture", "volume"};

constexpr TagRule kValues[] = {
    {"alias", "id as", ""},           {"blackbody", "name", "temperature scale"},
    {"boolean", "name value", ""},    {"default", "name value", ""},
    {"float", "name value", ""},      {"include", "filename", "name"},
    {"integer", "name value", ""},    {"path", "value", ""},
    {"point", "name", "value x y z"}, {"ref", "id", "name"},
    {"rgb", "name value", ""},        {"spectrum", "", "name value filename type id"},
    {"srgb", "name value", ""},       {"string", "name value", ""},
    {"transform", "name", ""},        {"vector", "name", "value x y z"},
};

constexpr TagRule kTransformSteps[] = {
    {"lookat", "origin target", "up"}, {"matrix", "value", ""},          {"rotate", "angle", "value x y z"},
    {"scale", "", "value x y z"},      {"translate", "", "value x y z"},
};

constexpr TagRule kObjectRule{"", "type", "id name"}, kSceneRule{"", "version", "type id name"};

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    result.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return result;
}

const TagRule* find(std::span<const TagRule> rules, std::string_view tag) {
  const auto found = std::find_if(rules.begin(), rules.end(), [&](const TagRule& rule) { return rule.tag == tag; });
  return found == rules.end() ? nullptr : &*found;
}

std::vector<std::string_view> all_tags() {
  std::vector<std::string_view> tags(std::begin(kObjects), std::end(kObjects));
  for (const TagRule& rule : kValues) tags.push_back(rule.tag);
  for (const TagRule& rule : kTransformSteps) tags.push_back(rule.tag);
  return tags;
}

[[noreturn]] void reject(const Element& element, const std::string& message) {
  throw Problem(message, element.where);
}

const TagRule& rule_for(const Element& element, std::string_view parent) {
  const std::string_view tag = element.tag;
  if (const TagRule* step = find(kTransformSteps, tag)) {
    if (parent != "transform") reject(element, fmt::format("<{}> stands in a <transform> only", tag));
    return *step;
  }
  const TagRule* value = find(kValues, tag);
  if (value == nullptr && !is_object_tag(tag))
    reject(element, fmt::format("scenes have no element <{}>{}", tag.substr(0, 60), did_you_mean(tag, all_tags())));
  if (parent == "transform") reject(element, fmt::format("<{}> has no place in a <transform>", tag));
  if (tag == "scene" && !parent.empty()) reject(element, "a <scene> cannot stand within a scene");
  if (tag == "path" && parent != "scene") reject(element, "<path> stands directly in <scene> only");
  if (value != nullptr) return *value;
  return tag == "scene" ? kSceneRule : kObjectRule;
}

/// toWorld → to_world, intIOR → int_ior.
std::string snake_case(std::string_view camel) {
  const auto is_upper = [](char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; };
  std::string snake;
  bool in_word = false;  // the capitals go on that a small letter stands before
  for (std::size_t i = 0; i < camel.size(); ++i) {
    const bool begins = i > 0 && is_upper(camel[i]) && std::islower(static_cast<unsigned char>(camel[i - 1])) != 0;
    in_word = is_upper(camel[i]) && (in_word || begins);
    if (begins) snake += '_';
    snake += in_word ? static_cast<char>(std::tolower(static_cast<unsigned char>(camel[i]))) : camel[i];
  }
  return snake;
}

}  // namespace

bool is_object_tag(std::string_view tag) {
  return std::find(std::begin(kObjects), std::end(kObjects), tag) != std::end(kObjects);
}

void check_element(const Element& element, std::string_view parent) {
  const TagRule& rule = rule_for(element, parent);
  const std::vector<std::string_view> required = words(rule.required);
  std::vector<std::string_view> known = words(rule.optional);
  known.insert(known.end(), required.begin(), required.end());
  if (parent.empty()) known.push_back("version");
  for (const Attribute& attribute : element.attributes)
    if (std::find(known.begin(), known.end(), attribute.name) == known.end())
      throw Problem(fmt::format("<{}> has no attribute {}{}", element.tag, in_quotes(attribute.name),
                                did_you_mean(attribute.name, known)),
                    attribute.where);
  for (const std::string_view name : required)
    if (element.find(name) == nullptr)
      reject(element, fmt::format("<{}> needs the attribute \"{}\"", element.tag, name));
}

void upgrade_names(Element& element, std::string_view parent_type) {
  if (element.tag == "lookAt") element.tag = "lookat";
  for (Attribute& attribute : element.attributes)
    if (attribute.name == "name") {
      attribute.value = snake_case(attribute.value);
      if (parent_type == "diffuse" && attribute.value == "diffuse_reflectance") attribute.value = "reflectance";
    }
}

}  // namespace etendue::mitsuba
