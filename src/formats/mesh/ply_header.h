#pragma once

#include <bit>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace etendue::ply {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of one number in a binary file.
std::size_t size_of(Type type);
/// The largest number of an integer type; 0 for the others.
double largest(Type type);

struct Property {
  std::string name;
  Type type;                  ///< of the number, or of each of the list's
  std::optional<Type> count;  ///< of a list: how its length is written
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;

  /// Index of the property with that name.
  std::optional<std::size_t> find(std::string_view property) const;
};

struct Header {
  std::optional<std::endian> byte_order;  ///< none: ascii
  std::vector<Element> elements;
  std::string_view body;      ///< the bytes behind the header
  std::size_t body_line = 1;  ///< in which its first byte stands
};

/// Reads what stands before "end_header". Throws Error(Failure::input), "NAME:LINE: …".
Header read_header(std::string_view bytes, const std::string& name);

}  // namespace etendue::ply
