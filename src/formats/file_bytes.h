#pragma once

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

namespace etendue {

/// All bytes of a file. Throws Error(Failure::input) that names it.
std::string read_file_bytes(const std::filesystem::path& file);

/// The number whose bytes start at `bytes`, in the given order.
template <typename T>
requires std::integral<T> || std::floating_point<T> T load_number(const char* bytes, std::endian order) {
  char ordered[sizeof(T)];
  std::memcpy(ordered, bytes, sizeof(T));
  if (order != std::endian::native) std::reverse(std::begin(ordered), std::end(ordered));
  return std::bit_cast<T>(ordered);
}

/// Adds the number's bytes to `bytes`, the little end first.
template <typename T>
requires std::integral<T> || std::floating_point<T>
void store_number(std::string& bytes, T number) {
  char ordered[sizeof(T)];
  std::memcpy(ordered, &number, sizeof(T));
  if (std::endian::native != std::endian::little) std::reverse(std::begin(ordered), std::end(ordered));
  bytes.append(ordered, sizeof(T));
}

/// Takes little-endian numbers off the front of bytes that came from a file.
class ByteReader {
 public:
  /// `name` stands for the file in messages; both must outlive the reader.
  ByteReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  std::size_t left() const { return bytes_.size() - position_; }
  /// The next number. Throws Error(Failure::input) at the end.
  template <typename T>
  T next() {
    return load_number<T>(take(sizeof(T)).data(), std::endian::little);
  }
  /// The next `count` bytes. Throws Error(Failure::input) if there are fewer.
  std::string_view take(std::size_t count);

 private:
  std::string_view bytes_;
  const std::string& name_;
  std::size_t position_ = 0;
};

}  // namespace etendue
