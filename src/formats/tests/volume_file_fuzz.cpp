// libFuzzer target: any bytes, read as a volume file. The reader may only return a grid or throw Error.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "formats/volume_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  etendue::Diagnostics diagnostics;
  try {
    etendue::parse_volume_file({reinterpret_cast<const char*>(data), size}, "fuzz.vol", diagnostics);
  } catch (const etendue::Error&) {
  }
  return 0;
}
