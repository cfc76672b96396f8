// libFuzzer target: any bytes, read as a Mitsuba scene. The reader may only return a scene or throw Error.

#include <cstddef>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "formats/mitsuba/mitsuba.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  etendue::Diagnostics diagnostics;
  try {
    etendue::mitsuba::read_text(std::string(reinterpret_cast<const char*>(data), size), "fuzz.xml", {}, diagnostics);
  } catch (const etendue::Error&) {
  }
  for (const etendue::Diagnostic& diagnostic : diagnostics.all()) (void)diagnostics.format(diagnostic);
  return 0;
}
