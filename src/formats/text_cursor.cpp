#include "formats/text_cursor.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>

#include "base/error.h"

namespace etendue {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
bool is_white(char c) {
  return is_blank(c) || c == '\n';
}

}  // namespace

bool TextCursor::skip_joined_line_end() {
  for (const std::string_view joint : {"\\\n", "\\\r\n"})
    if (text_.starts_with(joint)) {
      text_.remove_prefix(joint.size());
      ++line_;
      return true;
    }
  return false;
}

bool TextCursor::to_word() {
  while (!text_.empty()) {
    if (is_blank(text_.front()))
      text_.remove_prefix(1);
    else if (!skip_joined_line_end())
      return text_.front() != '\n' && text_.front() != '#';
  }
  return false;
}

bool TextCursor::to_word_in_any_line() {
  while (!text_.empty() && is_white(text_.front())) {
    line_ += text_.front() == '\n' ? 1 : 0;
    text_.remove_prefix(1);
  }
  return !text_.empty();
}

void TextCursor::to_next_line() {
  const std::size_t end = text_.find('\n');
  text_.remove_prefix(end == text_.npos ? text_.size() : end + 1);
  line_ += end == text_.npos ? 0 : 1;
}

bool TextCursor::skip(char c) {
  if (!text_.starts_with(c)) return false;
  text_.remove_prefix(1);
  return true;
}

std::string_view TextCursor::word() {
  std::size_t length = 0;
  while (length < text_.size() && !is_white(text_[length])) ++length;
  const std::string_view result = text_.substr(0, length);
  text_.remove_prefix(length);
  return result;
}

std::optional<double> TextCursor::number() {
  std::string_view digits = text_;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) value = std::numeric_limits<double>::infinity();
  text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
  return value;
}

std::optional<std::int64_t> TextCursor::integer() {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
  if (error != std::errc()) return std::nullopt;
  text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
  return value;
}

void TextCursor::reject(std::string_view message) const {
  throw Error(Failure::input, fmt::format("{}:{}: {}", name_, line_, message));
}

float to_float(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (value > kLargest) return std::numeric_limits<float>::infinity();
  if (value < -kLargest) return -std::numeric_limits<float>::infinity();
  return static_cast<float>(value);
}

}  // namespace etendue
