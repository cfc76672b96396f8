// libFuzzer target: any bytes, read as a COLLADA file. The reader may only return a scene or throw Error.

#include <cstddef>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "formats/collada/collada.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  etendue::Diagnostics diagnostics;
  try {
    etendue::collada::read_text(std::string(reinterpret_cast<const char*>(data), size), "fuzz.dae", diagnostics);
  } catch (const etendue::Error&) {
  }
  for (const etendue::Diagnostic& diagnostic : diagnostics.all()) (void)diagnostics.format(diagnostic);
  return 0;
}
