// Stands in for the library with the interface of version FAKE_VERSION: "denoises" by showing the albedo, or fails for
// pictures 13 pixels wide.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <map>
#include <string>

#define EXPORT extern "C" __attribute__((visibility("default")))

namespace {

struct Device {
  int error = 0;
};

struct Plane {
  float* pixels;
  std::size_t width, height;
};

struct Filter {
  Device* device;
  std::map<std::string, Plane> images;
  bool hdr = false, committed = false;
};

void set_bool(Filter* filter, const char* name, bool value) {
  if (std::strcmp(name, "hdr") == 0) filter->hdr = value;
}

}  // namespace

EXPORT Device* oidnNewDevice(int type) {
  return type == 1 ? new Device : nullptr;
}
EXPORT void oidnCommitDevice(Device*) {}
EXPORT void oidnReleaseDevice(Device* device) {
  delete device;
}
EXPORT int oidnGetDeviceError(Device* device, const char** message) {
  *message = "thirteen brings bad luck";
  return device->error;
}
EXPORT Filter* oidnNewFilter(Device* device, const char* type) {
  return std::strcmp(type, "RT") == 0 ? new Filter{device, {}} : nullptr;
}
EXPORT void oidnSetSharedFilterImage(Filter* filter, const char* name, void* pixels, int format, std::size_t width,
                                     std::size_t height, std::size_t offset, std::size_t, std::size_t) {
  if (format == 3 && offset == 0) filter->images[name] = {static_cast<float*>(pixels), width, height};
}
#if FAKE_VERSION == 1
EXPORT void oidnSetFilter1b(Filter* filter, const char* name, bool value) {
  set_bool(filter, name, value);
}
#else
EXPORT void oidnSetFilterBool(Filter* filter, const char* name, bool value) {
  set_bool(filter, name, value);
}
#endif
EXPORT void oidnCommitFilter(Filter* filter) {
  filter->committed = true;
}
EXPORT void oidnExecuteFilter(Filter* filter) {
  const Plane &albedo = filter->images["albedo"], &output = filter->images["output"];
  const bool complete = filter->images.count("color") == 1 && filter->images.count("normal") == 1;
  filter->device->error = complete && filter->hdr && filter->committed && output.width != 13 ? 0 : 1;
  if (filter->device->error == 0) std::copy_n(albedo.pixels, 3 * albedo.width * albedo.height, output.pixels);
}
EXPORT void oidnReleaseFilter(Filter* filter) {
  delete filter;
}
