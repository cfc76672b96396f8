#include "formats/mesh/ply_attributes.h"

#include <algorithm>
#include <array>

namespace etendue::ply {
namespace {

constexpr std::string_view kSuffixes[] = {"xyzw", "rgba", "0123", "1234"};
constexpr std::string_view kColorSuffixes = kSuffixes[1];

/// NAME_c taken apart.
struct SuffixedName {
  std::string_view name;
  char suffix = 0;
};

SuffixedName take_apart(const Property& property) {
  const std::string_view whole = property.name;
  if (property.count || whole.size() < 3 || whole[whole.size() - 2] != '_') return {};
  return {whole.substr(0, whole.size() - 2), whole.back()};
}

/// How many properties from `first` on are NAME with the first, second, … of `suffixes`.
std::size_t run_length(const Element& element, std::size_t first, std::string_view suffixes) {
  const std::string_view name = take_apart(element.properties[first]).name;
  std::size_t length = 0;
  while (length < suffixes.size() && first + length < element.properties.size()) {
    const SuffixedName next = take_apart(element.properties[first + length]);
    if (next.name != name || next.suffix != suffixes[length]) break;
    ++length;
  }
  return length;
}

void add(std::vector<Attribute>& attributes, Attribute attribute) {
  const auto has_same_name = [&](const Attribute& other) { return other.name == attribute.name; };
  if (std::none_of(attributes.begin(), attributes.end(), has_same_name)) attributes.push_back(std::move(attribute));
}

void add_color(std::vector<Attribute>& attributes, const Element& element, const std::string& prefix,
               const std::array<std::string_view, 3>& names) {
  Attribute color{prefix + "color", {}};
  for (const std::string_view name : names) {
    const std::optional<std::size_t> channel = element.find(name);
    if (!channel || element.properties[*channel].count) return;
    color.properties.push_back(*channel);
  }
  add(attributes, std::move(color));
}

}  // namespace

std::vector<Attribute> find_attributes(const Element& element, const std::string& prefix) {
  std::vector<Attribute> attributes;
  add_color(attributes, element, prefix, {"r", "g", "b"});
  add_color(attributes, element, prefix, {"red", "green", "blue"});
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const SuffixedName first = take_apart(element.properties[i]);
    const auto* suffixes = std::find_if(std::begin(kSuffixes), std::end(kSuffixes),
                                        [&](std::string_view s) { return s.front() == first.suffix; });
    if (suffixes == std::end(kSuffixes)) continue;
    const std::size_t length = run_length(element, i, *suffixes);
    if (length == 1 || length == 3) {
      Attribute attribute{prefix + std::string(first.name) + (*suffixes == kColorSuffixes ? "_color" : ""), {}};
      for (std::size_t c = 0; c < length; ++c) attribute.properties.push_back(i + c);
      add(attributes, std::move(attribute));
    }
    i += length - 1;
  }
  return attributes;
}

}  // namespace etendue::ply
