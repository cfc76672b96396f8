#include "formats/collada/sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "formats/collada/numbers.h"

namespace etendue::collada {
namespace {

constexpr std::uint64_t kNotGiven = std::numeric_limits<std::uint64_t>::max();

/// Which numbers of a group of `stride` are the components: those whose <param> has a name; the first ones if none has.
std::vector<std::size_t> component_slots(pugi::xml_node accessor, std::uint64_t stride) {
  std::vector<std::size_t> slots;
  std::size_t position = 0;
  for (const pugi::xml_node param : accessor.children("param")) {
    if (position < stride && !std::string_view(param.attribute("name").value()).empty()) slots.push_back(position);
    ++position;
  }
  if (slots.empty())
    for (std::size_t i = 0; i < 3 && i < stride; ++i) slots.push_back(i);
  return slots;
}

}  // namespace

const std::vector<float>& SourceLibrary::floats(pugi::xml_node array) {
  if (const auto known = arrays_.find(array.internal_object()); known != arrays_.end()) return known->second;

  const std::uint64_t claimed = read_count(document_, array, "count", kNotGiven);
  NumberStream stream(document_, array);
  std::vector<float> values;
  values.reserve(std::min<std::uint64_t>(claimed, stream.most_left()));
  while (!stream.at_end()) values.push_back(stream.next_float());
  if (claimed != kNotGiven && claimed != values.size())
    throw Problem(fmt::format("<{}> says count=\"{}\", but holds {} numbers", array.name(), claimed, values.size()),
                  document_.locate(array));
  return arrays_.emplace(array.internal_object(), std::move(values)).first->second;
}

Accessor SourceLibrary::read(pugi::xml_node source, std::size_t components) {
  const pugi::xml_node accessor = source.child("technique_common").child("accessor");
  if (!accessor) throw Problem("<source> has no <technique_common><accessor>", document_.locate(source));
  const std::string_view url = accessor.attribute("source").value();
  const bool is_int = url.starts_with('#') && document_.find("int_array", url.substr(1));
  const std::vector<float>& data =
      floats(document_.referenced(accessor, "source", is_int ? "int_array" : "float_array"));

  const SourceLocation where = document_.locate(accessor);
  const std::uint64_t stride = read_count(document_, accessor, "stride", 1);
  const std::uint64_t offset = std::min<std::uint64_t>(read_count(document_, accessor, "offset", 0), data.size());
  const std::vector<std::size_t> slots = component_slots(accessor, stride);
  if (slots.size() < components)
    throw Problem(fmt::format("<accessor> yields {} numbers for each vertex, {} are needed: its stride is {}",
                              slots.size(), components, stride),
                  where);
  const std::uint64_t count = read_count(document_, accessor, "count", kNotGiven);
  if (count == kNotGiven) throw Problem("<accessor> has no count", where);
  const std::uint64_t room = data.size() - offset;
  const std::size_t last_slot = *std::max_element(slots.begin(), slots.begin() + components);
  const std::uint64_t most = room > last_slot ? (room - last_slot - 1) / stride + 1 : 0;
  if (count > most)
    throw Problem(fmt::format("<accessor> says count=\"{}\", but its array holds numbers for {} only", count, most),
                  where);
  return {data.data() + offset, count, stride, {slots[0], slots[1], slots[components - 1]}};
}

}  // namespace etendue::collada
