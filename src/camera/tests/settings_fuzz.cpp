// libFuzzer target: any bytes, read as camera settings. The reader may only return a camera or throw Error.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "base/error.h"
#include "camera/settings_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const etendue::Camera camera = etendue::parse_camera_settings(text, "fuzz.txt", 640, 480);
    if (!(camera.tan_half_x > 0 && std::isfinite(camera.tan_half_x))) std::abort();
  } catch (const etendue::Error&) {
  }
  return 0;
}
