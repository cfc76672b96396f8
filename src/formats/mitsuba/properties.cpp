#include "formats/mitsuba/properties.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "formats/mitsuba/transforms.h"
#include "formats/mitsuba/values.h"

namespace etendue::mitsuba {
namespace {

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string_view trimmed(std::string_view text) {
  const std::vector<std::string_view> words = words_of(text);
  return words.size() == 1 ? words.front() : text;
}

}  // namespace

Properties::Properties(const Document& document, const Element& object, Report& report)
    : document_(document), object_(object), report_(report) {
  for (const Element* child : object.children) children_.push_back({child, &document.resolved(*child)});
  for (auto child = children_.begin(); child != children_.end(); ++child) {
    const std::string_view name = child->element->name();
    const auto is_same = [&](const Child& other) { return other.element->name() == name; };
    if (!name.empty() && std::any_of(children_.begin(), child, is_same))
      throw Problem(fmt::format("{} is given twice", in_quotes(name)), child->element->where);
  }
}

std::string Properties::name() const {
  return std::string(object_["id"].empty() ? object_.type() : object_["id"]);
}

const Element* Properties::find(std::string_view name) {
  asked_.emplace(name);
  for (Child& child : children_)
    if (child.element->name() == name) {
      child.read = true;
      return child.target;
    }
  return nullptr;
}

void Properties::reject(const Element& element, const std::string& what) const {
  throw Problem(fmt::format("{} of {} {}", in_quotes(element.name()), in_quotes(type()), what), element.where);
}

const Element* Properties::value(std::string_view name, std::initializer_list<std::string_view> tags) {
  const Element* element = find(name);
  if (element == nullptr || std::find(tags.begin(), tags.end(), element->tag) != tags.end()) return element;
  reject(*element, fmt::format("is a <{}>; it needs to be a <{}>", element->tag, fmt::join(tags, "> or <")));
}

std::optional<float> Properties::number(std::string_view name) {
  const Element* element = value(name, {"float", "integer"});
  if (element == nullptr) return std::nullopt;
  const Attribute& attribute = mitsuba::required(*element, "value");
  return to_number(trimmed(attribute.value), attribute);
}

float Properties::number(std::string_view name, float missing, float least, float most) {
  const float given = number(name, missing);
  if (!(given >= least && given <= most))
    reject(*find(name), most < 1e30f ? fmt::format("is {}; it needs to be in {} … {}", given, least, most)
                                     : fmt::format("is {}; it needs to be at least {}", given, least));
  return given;
}

std::optional<int> Properties::integer(std::string_view name) {
  const Element* element = value(name, {"integer", "float"});
  if (element == nullptr) return std::nullopt;
  const Attribute& attribute = mitsuba::required(*element, "value");
  const float given = to_number(trimmed(attribute.value), attribute);
  if (given != std::floor(given) || std::abs(given) > 2147483520.0f)
    reject(*element, fmt::format("is {}; it needs to be a whole number", given));
  const std::string_view word = trimmed(attribute.value);
  int exact = 0;
  const bool is_exact = std::from_chars(word.data(), word.data() + word.size(), exact).ptr == word.data() + word.size();
  return is_exact ? exact : static_cast<int>(given);
}

int Properties::integer(std::string_view name, int missing, int least, int most) {
  const int given = integer(name).value_or(missing);
  if (given < least || given > most)
    reject(*find(name), fmt::format("is {}; it needs to be in {} … {}", given, least, most));
  return given;
}

bool Properties::boolean(std::string_view name, bool missing) {
  const Element* element = value(name, {"boolean"});
  if (element == nullptr) return missing;
  const Attribute& attribute = mitsuba::required(*element, "value");
  const std::string word = lower_case(trimmed(attribute.value));
  if (word == "true") return true;
  if (word == "false") return false;
  throw Problem(fmt::format("{} is neither true nor false", in_quotes(attribute.value)), attribute.where);
}

std::optional<std::string> Properties::text(std::string_view name) {
  const Element* element = value(name, {"string"});
  if (element == nullptr) return std::nullopt;
  return std::string((*element)["value"]);
}

std::string Properties::required_text(std::string_view name) {
  if (auto given = text(name)) return *std::move(given);
  throw Problem(fmt::format("{} needs a <string name=\"{}\">", in_quotes(type()), name), where());
}

std::size_t Properties::choice(std::string_view name, std::initializer_list<std::string_view> known) {
  const Element* element = value(name, {"string"});
  if (element == nullptr) return 0;
  const Attribute& attribute = mitsuba::required(*element, "value");
  const std::string word = lower_case(attribute.value);
  const auto found = std::find(known.begin(), known.end(), word);
  if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
  throw Problem(fmt::format("{} of {} cannot be {}; it can be {}", in_quotes(name), in_quotes(type()),
                            in_quotes(attribute.value), fmt::join(known, ", ")),
                attribute.where);
}

std::optional<Vec3> Properties::vector(std::string_view name) {
  const Element* element = value(name, {"vector", "point"});
  if (element == nullptr) return std::nullopt;
  if (element->find("value") == nullptr)
    for (const std::string_view axis : {"x", "y", "z"}) mitsuba::required(*element, axis);
  return vector_of(*element, 0);
}

Transform Properties::transform(std::string_view name) {
  const Element* element = value(name, {"transform"});
  return element == nullptr ? Transform() : read_transform(*element, report_);
}

std::filesystem::path Properties::file(std::string_view name) {
  const std::string given = required_text(name);
  return document_.find_file(given, mitsuba::required(*find(name), "value").where);
}

std::vector<const Element*> Properties::objects(std::string_view tag) {
  asked_.emplace(tag);
  std::vector<const Element*> result;
  for (Child& child : children_)
    if (child.target->is_object() && child.target->tag == tag) {
      child.read = true;
      result.push_back(child.target);
    }
  return result;
}

const Element* Properties::object(std::string_view tag) {
  const std::vector<const Element*> all = objects(tag);
  if (all.size() > 1) throw Problem(fmt::format("{} holds more than one <{}>", in_quotes(type()), tag), all[1]->where);
  return all.empty() ? nullptr : all.front();
}

void Properties::ignore(std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) find(name);
}

void Properties::reject_unread() {
  const std::vector<std::string_view> known(asked_.begin(), asked_.end());
  for (const Child& child : children_) {
    if (child.read) continue;
    const std::string_view name = child.element->name();
    const std::string what = name.empty() ? fmt::format("no use for a <{}>", child.target->tag)
                                          : fmt::format("no property {}", in_quotes(name));
    const std::string hint = name.empty() ? "" : did_you_mean(name, known);
    const std::string owner = object_.tag + (type().empty() ? "" : " type=" + in_quotes(type()));
    report_.error(Problem(fmt::format("<{}> has {}{}", owner, what, hint), child.element->where));
  }
}

}  // namespace etendue::mitsuba
