#include "formats/mitsuba/ior.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "formats/mitsuba/values.h"

namespace etendue::mitsuba {
namespace {

struct NamedIndex {
  std::string_view name;
  float index;
};

/// Near 589 nm and room temperature (Hecht, Optics), by the names that scene files use.
constexpr NamedIndex kNamedIndices[] = {
    {"acetone", 1.36f},
    {"acrylic glass", 1.49f},
    {"air", 1.000277f},
    {"amber", 1.55f},
    {"benzene", 1.501f},
    {"bk7", 1.5046f},
    {"bromine", 1.661f},
    {"carbon dioxide", 1.00045f},
    {"carbon tetrachloride", 1.461f},
    {"diamond", 2.419f},
    {"ethanol", 1.361f},
    {"fused quartz", 1.458f},
    {"glycerol", 1.4729f},
    {"helium", 1.000036f},
    {"hydrogen", 1.000132f},
    {"pet", 1.575f},
    {"polypropylene", 1.49f},
    {"pyrex", 1.47f},
    {"silicone oil", 1.52045f},
    {"sodium chloride", 1.544f},
    {"vacuum", 1.0f},
    {"water", 1.333f},
    {"water ice", 1.31f},
};

std::optional<float> named_index(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const NamedIndex& known : kNamedIndices)
    if (known.name == lower) return known.index;
  return std::nullopt;
}

}  // namespace

float index_of_refraction(Properties& properties, std::string_view name, std::string_view missing) {
  const Element* element = properties.find(name);
  if (element == nullptr) return *named_index(missing);
  if (element->tag == "string") {
    const Attribute& value = required(*element, "value");
    if (const auto index = named_index(value.value)) return *index;
    std::vector<std::string_view> names;
    for (const NamedIndex& known : kNamedIndices) names.push_back(known.name);
    throw Problem(fmt::format("no index of refraction is known for {}{}", in_quotes(value.value),
                              did_you_mean(value.value, names)),
                  value.where);
  }
  const float index = properties.number(name, 1);
  if (!(index > 0))
    throw Problem(fmt::format("{} is {}; an index of refraction is above zero", in_quotes(name), index),
                  element->where);
  return index;
}

}  // namespace etendue::mitsuba
