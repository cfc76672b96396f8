#include "formats/mesh/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "formats/text_cursor.h"

namespace etendue::ply {
namespace {

struct NamedType {
  std::string_view name;
  Type type;
};
constexpr NamedType kTypes[] = {
    {"char", Type::int8},   {"uchar", Type::uint8},   {"short", Type::int16},     {"ushort", Type::uint16},
    {"int", Type::int32},   {"uint", Type::uint32},   {"float", Type::float32},   {"double", Type::float64},
    {"int8", Type::int8},   {"uint8", Type::uint8},   {"int16", Type::int16},     {"uint16", Type::uint16},
    {"int32", Type::int32}, {"uint32", Type::uint32}, {"float32", Type::float32}, {"float64", Type::float64},
};

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& name) : bytes_(bytes), cursor_(bytes, name) {}

  Header read() {
    if (next_word("\"ply\"") != "ply") cursor_.reject("this is not a PLY file: it does not begin with \"ply\"");
    for (cursor_.to_next_line(); cursor_.left() > 0; cursor_.to_next_line()) {
      if (!cursor_.to_word()) continue;
      const std::string_view keyword = cursor_.word();
      if (keyword == "format") read_format();
      if (keyword == "element") read_element();
      if (keyword == "property") read_property();
      if (keyword == "end_header") return end();
    }
    cursor_.reject("the header has no end: \"end_header\" is missing");
  }

 private:
  std::string_view next_word(std::string_view what) {
    if (!cursor_.to_word()) cursor_.reject(fmt::format("the header lacks {} here", what));
    return cursor_.word();
  }

  Type type(std::string_view word) const {
    for (const NamedType& known : kTypes)
      if (known.name == word) return known.type;
    cursor_.reject(fmt::format("the type \"{}\" is not known", word));
  }

  void read_format() {
    const std::string_view format = next_word("the format");
    if (format == "binary_little_endian")
      header_.byte_order = std::endian::little;
    else if (format == "binary_big_endian")
      header_.byte_order = std::endian::big;
    else if (format != "ascii")
      cursor_.reject(
          fmt::format("the format \"{}\" is not known; known are ascii, binary_little_endian and "
                      "binary_big_endian",
                      format));
    has_format_ = true;
  }

  void read_element() {
    Element element;
    element.name = next_word("the element's name");
    const std::optional<std::int64_t> count = cursor_.to_word() ? cursor_.integer() : std::nullopt;
    if (!count || *count < 0) cursor_.reject(fmt::format("the element \"{}\" needs a count", element.name));
    element.count = static_cast<std::size_t>(*count);
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty()) cursor_.reject("a property stands before the first element");
    Property property{};
    std::string_view word = next_word("a type");
    if (word == "list") {
      property.count = type(next_word("the type of the list's length"));
      if (largest(*property.count) == 0) cursor_.reject("the length of a list must be a whole number");
      word = next_word("a type");
    }
    property.type = type(word);
    property.name = next_word("the property's name");
    header_.elements.back().properties.push_back(std::move(property));
  }

  Header end() {
    if (!has_format_) cursor_.reject("the header does not say the format");
    cursor_.to_next_line();
    header_.body = bytes_.substr(bytes_.size() - cursor_.left());
    header_.body_line = cursor_.line();
    return std::move(header_);
  }

  std::string_view bytes_;
  TextCursor cursor_;
  Header header_;
  bool has_format_ = false;
};

}  // namespace

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

double largest(Type type) {
  constexpr std::array<double, 8> kLargest = {127, 255, 32767, 65535, 2147483647, 4294967295, 0, 0};
  return kLargest[static_cast<std::size_t>(type)];
}

std::optional<std::size_t> Element::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return i;
  return std::nullopt;
}

Header read_header(std::string_view bytes, const std::string& name) {
  return HeaderReader(bytes, name).read();
}

}  // namespace etendue::ply
