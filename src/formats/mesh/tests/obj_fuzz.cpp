// libFuzzer target: any bytes, read as OBJ. The reader may only return a mesh or throw Error.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "formats/mesh/obj.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  etendue::Diagnostics diagnostics;
  try {
    etendue::parse_obj({reinterpret_cast<const char*>(data), size}, "fuzz.obj", {}, diagnostics);
  } catch (const etendue::Error&) {
  }
  return 0;
}
