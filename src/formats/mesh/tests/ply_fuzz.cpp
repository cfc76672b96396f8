// libFuzzer target: any bytes, read as PLY. The reader may only return a mesh or throw Error.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "formats/mesh/ply.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  etendue::Diagnostics diagnostics;
  try {
    etendue::parse_ply({reinterpret_cast<const char*>(data), size}, "fuzz.ply", {}, diagnostics);
  } catch (const etendue::Error&) {
  }
  return 0;
}
