#include "formats/file_bytes.h"

#include <fmt/format.h>

#include <fstream>

#include "base/error.h"

namespace etendue {

std::string read_file_bytes(const std::filesystem::path& file) {
  const auto fail = [&](std::string_view why) {
    throw Error(Failure::input, fmt::format("{}: {}", file.string(), why));
  };
  std::error_code error;
  if (!std::filesystem::exists(file, error)) fail("there is no such file");
  if (!std::filesystem::is_regular_file(file, error)) fail("this is not a regular file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail("the file cannot be opened for reading; check its permissions");
  std::string bytes(std::filesystem::file_size(file), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

std::string_view ByteReader::take(std::size_t count) {
  if (count > left())
    throw Error(Failure::input,
                fmt::format("{}: the file ends at byte {}, where more should follow; it is not complete", name_,
                            bytes_.size()));
  position_ += count;
  return bytes_.substr(position_ - count, count);
}

}  // namespace etendue
