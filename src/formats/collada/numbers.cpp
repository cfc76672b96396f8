#include "formats/collada/numbers.h"

#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <limits>

namespace etendue::collada {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

bool is_text(pugi::xml_node node) {
  return node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata;
}

pugi::xml_node text_from(pugi::xml_node node) {
  while (node && !is_text(node)) node = node.next_sibling();
  return node;
}

}  // namespace

NumberStream::NumberStream(const Document& document, pugi::xml_node element)
    : document_(document), element_(element), next_text_(text_from(element.first_child())) {
  open(element.value());
}

void NumberStream::open(const char* text) {
  cursor_ = text;
  end_ = text + std::strlen(text);
}

bool NumberStream::at_end() {
  for (;;) {
    while (cursor_ != end_ && is_space(*cursor_)) ++cursor_;
    if (cursor_ != end_) return false;
    if (!next_text_) return true;
    open(next_text_.value());
    next_text_ = text_from(next_text_.next_sibling());
  }
}

std::size_t NumberStream::most_left() const {
  std::size_t bytes = static_cast<std::size_t>(end_ - cursor_) + 1;
  for (pugi::xml_node text = next_text_; text; text = text_from(text.next_sibling()))
    bytes += std::strlen(text.value()) + 1;
  return bytes / 2;
}

void NumberStream::start_token() {
  if (at_end()) throw Problem(fmt::format("<{}> ends where a number is needed", element_.name()), where());
  token_ = cursor_;
  if (*cursor_ == '+' && cursor_ + 1 != end_ && cursor_[1] != '-')
    ++cursor_;  // XML Schema allows it, from_chars does not
}

bool NumberStream::at_token_end() const {
  return cursor_ == end_ || is_space(*cursor_);
}

std::string_view NumberStream::token() const {
  const char* stop = token_;
  while (stop != end_ && !is_space(*stop)) ++stop;
  return {token_, static_cast<std::size_t>(stop - token_)};
}

void NumberStream::reject(std::string_view what) const {
  throw Problem(fmt::format("{} in <{}> is not {}", in_quotes(token()), element_.name(), what), where());
}

float NumberStream::next_float() {
  start_token();
  float value = 0;
  const auto [stop, status] = std::from_chars(cursor_, end_, value);
  if (status != std::errc()) return unusual_float();
  cursor_ = stop;
  return at_token_end() ? value : unusual_float();
}

/// What std::from_chars does not take as a float but exporters write: too large or too small a number, and "-1.#IND".
float NumberStream::unusual_float() {
  const std::string_view text = token();
  const char* const begin = text.data() + (text.front() == '+' ? 1 : 0);
  const char* const stop = text.data() + text.size();
  cursor_ = stop;
  if (text.find(".#") != std::string_view::npos) return std::numeric_limits<float>::quiet_NaN();
  double value = 0;
  const auto [parsed, status] = std::from_chars(begin, stop, value);
  if (parsed != stop || status == std::errc::invalid_argument) reject("a number");
  if (status == std::errc()) {
    if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max()))
      return std::numeric_limits<float>::infinity();
    return static_cast<float>(value);
  }
  const bool tiny = text.find("e-") != std::string_view::npos || text.find("E-") != std::string_view::npos;
  return tiny ? 0.0f : std::numeric_limits<float>::infinity();
}

std::int64_t NumberStream::next_integer() {
  start_token();
  std::int64_t value = 0;
  const auto [stop, status] = std::from_chars(cursor_, end_, value);
  cursor_ = stop;
  if (status != std::errc() || !at_token_end()) reject("a whole number");
  return value;
}

SourceLocation NumberStream::where() const {
  return token_ == nullptr ? document_.locate(element_) : document_.locate(token_);
}

std::vector<float> read_numbers(const Document& document, pugi::xml_node element, std::size_t least, std::size_t most) {
  NumberStream stream(document, element);
  std::vector<float> numbers;
  while (numbers.size() < most && !stream.at_end()) numbers.push_back(stream.next_float());
  if (numbers.size() < least)
    throw Problem(fmt::format("<{}> needs {} numbers, it has {}", element.name(), least, numbers.size()),
                  document.locate(element));
  if (!stream.at_end())
    throw Problem(fmt::format("<{}> has more than the {} numbers that belong there", element.name(), most),
                  document.locate(element));
  return numbers;
}

float read_number(const Document& document, pugi::xml_node element) {
  return read_numbers(document, element, 1, 1).front();
}

std::uint64_t read_count(const Document& document, pugi::xml_node element, const char* attribute,
                         std::uint64_t missing) {
  const pugi::xml_attribute found = element.attribute(attribute);
  if (!found) return missing;
  const std::string_view text = found.value();
  std::uint64_t value = 0;
  const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || status != std::errc() || stop != text.data() + text.size())
    throw Problem(
        fmt::format("{}={} of <{}> is not a whole number from 0 on", attribute, in_quotes(text), element.name()),
        document.locate(found.value()));
  return value;
}

}  // namespace etendue::collada
