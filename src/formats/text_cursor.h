#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace etendue {

/// Walks through a text file that was read, word by word, and knows the line.
class TextCursor {
 public:
  /// `name` stands for the file in messages; both must outlive the cursor.
  TextCursor(std::string_view text, const std::string& name, std::size_t first_line = 1)
      : text_(text), name_(name), line_(first_line) {}

  std::size_t line() const { return line_; }
  std::size_t left() const { return text_.size(); }
  /// Goes to the next word of this line; false if there is none. A backslash joins a line to the next, '#' ends it.
  bool to_word();
  /// Goes to the next word of the file, in whatever line; false if there is none.
  bool to_word_in_any_line();
  /// Goes behind this line's end.
  void to_next_line();
  /// Whether the next character is `c`; then goes behind it.
  bool skip(char c);
  /// Takes the characters up to the next white space.
  std::string_view word();
  /// Takes the number that starts here; nothing if there is none. What no double can hold is infinite.
  std::optional<double> number();
  std::optional<std::int64_t> integer();
  /// Throws Error(Failure::input), "NAME:LINE: message".
  [[noreturn]] void reject(std::string_view message) const;

 private:
  bool skip_joined_line_end();

  std::string_view text_;
  const std::string& name_;
  std::size_t line_;
};

/// A double as a float, infinite where it is too large.
float to_float(double value);

}  // namespace etendue
