#include "formats/mitsuba/values.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace etendue::mitsuba {
namespace {

constexpr std::string_view kSeparators = ", \t\r\n";

float component(const Element& element, std::string_view name, float missing) {
  const Attribute* attribute = element.find(name);
  if (attribute == nullptr) return missing;
  const std::vector<float> numbers = numbers_of(*attribute);
  if (numbers.size() != 1)
    throw Problem(fmt::format("{}={} of <{}> is not a number", name, in_quotes(attribute->value), element.tag),
                  attribute->where);
  return numbers.front();
}

}  // namespace

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t begin = text.find_first_not_of(kSeparators); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kSeparators, end);
  }
  return words;
}

float to_number(std::string_view word, const Attribute& attribute) {
  const std::size_t sign = word.size() > 1 && word[0] == '+' && word[1] != '-' ? 1 : 0;  // from_chars takes no plus
  double value = 0;
  const auto [stop, status] = std::from_chars(word.data() + sign, word.data() + word.size(), value);
  if (status == std::errc::invalid_argument || stop != word.data() + word.size())
    throw Problem(fmt::format("{} is not a number", in_quotes(word)), attribute.where);
  const bool is_tiny = status == std::errc::result_out_of_range && word.find("e-") != std::string_view::npos;
  if (is_tiny) return 0;
  if (status != std::errc() || !std::isfinite(static_cast<float>(value)))
    throw Problem(fmt::format("{} is not a finite number", in_quotes(word)), attribute.where);
  return static_cast<float>(value);
}

std::vector<float> numbers_of(const Attribute& attribute) {
  std::vector<float> numbers;
  for (const std::string_view word : words_of(attribute.value)) numbers.push_back(to_number(word, attribute));
  return numbers;
}

const Attribute& required(const Element& element, std::string_view name) {
  const Attribute* attribute = element.find(name);
  if (attribute == nullptr)
    throw Problem(fmt::format("<{}> needs the attribute \"{}\"", element.tag, name), element.where);
  return *attribute;
}

Vec3 vector_of(const Element& element, float missing) {
  const Attribute* value = element.find("value");
  if (value == nullptr)
    return {component(element, "x", missing), component(element, "y", missing), component(element, "z", missing)};
  if (element.find("x") != nullptr || element.find("y") != nullptr || element.find("z") != nullptr)
    throw Problem(fmt::format("<{}> has both \"value\" and x, y, z; one of them is enough", element.tag),
                  element.where);
  const std::vector<float> v = numbers_of(*value);
  if (v.size() == 1) return Vec3(v[0]);
  if (v.size() == 3) return {v[0], v[1], v[2]};
  throw Problem(
      fmt::format("value={} of <{}> has {} numbers; it needs three", in_quotes(value->value), element.tag, v.size()),
      value->where);
}

}  // namespace etendue::mitsuba
