// libFuzzer target: any bytes, read as a serialized file of meshes, and what they would be as the inside of one that is
// compressed properly. The reader may only return a mesh or throw Error.

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/error.h"
#include "formats/mesh/serialized.h"

namespace {

void read(std::string_view bytes, int shape_index) {
  etendue::Diagnostics diagnostics;
  try {
    etendue::parse_serialized(bytes, "fuzz.serialized", shape_index, {}, diagnostics);
  } catch (const etendue::Error&) {
  }
}

std::string in_compressed_file(std::string_view content) {
  uLongf size = compressBound(content.size());
  std::string compressed(size, '\0');
  compress(reinterpret_cast<Bytef*>(compressed.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
           content.size());
  compressed.resize(size);
  return std::string("\x1c\x04\x04\x00", 4) + compressed;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const int shape_index : {0, 1}) read(bytes, shape_index);
  read(in_compressed_file(bytes), 0);
  return 0;
}
