#pragma once

#include <array>
#include <cstdint>
#include <pugixml.hpp>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "formats/collada/document.h"

namespace etendue::collada {

/// The numbers in one element's text, one after the other, whatever white space, comments or CDATA sections part them.
/// Nothing is copied; the document must outlive the stream.
class NumberStream {
 public:
  NumberStream(const Document& document, pugi::xml_node element);

  /// Whether no number is left.
  bool at_end();
  /// The next number; not finite for "nan", "inf" and what no float can hold. Throws Problem at anything else, or at
  /// the end.
  float next_float();
  /// The next whole number. Throws Problem likewise.
  std::int64_t next_integer();
  /// Place of the number that was read last; of the element before that.
  SourceLocation where() const;
  /// No more numbers than this are left, whatever the file claims: for reserving memory.
  std::size_t most_left() const;

 private:
  void start_token();
  bool at_token_end() const;
  std::string_view token() const;
  [[noreturn]] void reject(std::string_view what) const;
  float unusual_float();
  void open(const char* text);

  const Document& document_;
  pugi::xml_node element_, next_text_;
  const char* cursor_ = nullptr;
  const char* end_ = nullptr;
  const char* token_ = nullptr;
};

/// The numbers of an element that holds between `least` and `most` of them. Throws Problem if it does not.
std::vector<float> read_numbers(const Document& document, pugi::xml_node element, std::size_t least, std::size_t most);
/// The one number of an element.
float read_number(const Document& document, pugi::xml_node element);
/// A whole number, at least zero, in an attribute; `missing` if there is no such attribute. Throws Problem otherwise.
std::uint64_t read_count(const Document& document, pugi::xml_node element, const char* attribute,
                         std::uint64_t missing);

}  // namespace etendue::collada
