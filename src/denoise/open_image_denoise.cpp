#include "denoise/open_image_denoise.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "base/log.h"

namespace etendue {

/// The library's C interface, as far as it is used: the same in versions 1 and 2, but for one name.
struct OpenImageDenoise::Library {
  struct Device;
  struct Filter;
  static constexpr int kProcessor = 1, kThreeFloats = 3, kNoError = 0;

  void* handle = nullptr;
  Device* (*new_device)(int type) = nullptr;
  void (*commit_device)(Device*) = nullptr;
  void (*release_device)(Device*) = nullptr;
  int (*device_error)(Device*, const char** message) = nullptr;
  Filter* (*new_filter)(Device*, const char* type) = nullptr;
  void (*set_image)(Filter*, const char* name, void* pixels, int format, std::size_t width, std::size_t height,
                    std::size_t byte_offset, std::size_t pixel_stride, std::size_t row_stride) = nullptr;
  void (*set_bool)(Filter*, const char* name, bool value) = nullptr;
  void (*commit_filter)(Filter*) = nullptr;
  void (*execute_filter)(Filter*) = nullptr;
  void (*release_filter)(Filter*) = nullptr;

  Library() = default;
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() {
    if (handle != nullptr) ::dlclose(handle);
  }

  bool open(const char* file);

 private:
  template <typename Function>
  bool find(Function& function, const char* name) {
    function = reinterpret_cast<Function>(::dlsym(handle, name));
    return function != nullptr;
  }
};

bool OpenImageDenoise::Library::open(const char* file) {
  handle = ::dlopen(file, RTLD_NOW | RTLD_LOCAL);
  return handle != nullptr && find(new_device, "oidnNewDevice") && find(commit_device, "oidnCommitDevice") &&
         find(release_device, "oidnReleaseDevice") && find(device_error, "oidnGetDeviceError") &&
         find(new_filter, "oidnNewFilter") && find(set_image, "oidnSetSharedFilterImage") &&
         (find(set_bool, "oidnSetFilterBool") || find(set_bool, "oidnSetFilter1b")) &&
         find(commit_filter, "oidnCommitFilter") && find(execute_filter, "oidnExecuteFilter") &&
         find(release_filter, "oidnReleaseFilter");
}

std::optional<OpenImageDenoise> OpenImageDenoise::load() {
  for (const char* file : {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1"}) {
    auto library = std::make_shared<Library>();
    if (library->open(file)) return OpenImageDenoise(std::move(library));
  }
  return std::nullopt;
}

std::optional<Image> OpenImageDenoise::filter(const Image& color, const Image& albedo, const Image& normal) const {
  const Library& l = *library_;
  Image result(color.width(), color.height());
  const std::unique_ptr<Library::Device, void (*)(Library::Device*)> device(l.new_device(Library::kProcessor),
                                                                            l.release_device);
  if (device) {
    l.commit_device(device.get());
    const std::unique_ptr<Library::Filter, void (*)(Library::Filter*)> filter(l.new_filter(device.get(), "RT"),
                                                                              l.release_filter);
    const auto give = [&](const char* name, const Image& image) {
      l.set_image(filter.get(), name, const_cast<Spectrum*>(image.pixels().data()), Library::kThreeFloats,
                  static_cast<std::size_t>(image.width()), static_cast<std::size_t>(image.height()), 0, 0, 0);
    };
    if (filter) {
      give("color", color);
      give("albedo", albedo);
      give("normal", normal);
      give("output", result);
      l.set_bool(filter.get(), "hdr", true);
      l.commit_filter(filter.get());
      l.execute_filter(filter.get());
    }
  }
  const char* message = nullptr;
  if (device && l.device_error(device.get(), &message) == Library::kNoError) return result;
  log_warning(fmt::format("warning: Open Image Denoise failed ({}); denoising without it",
                          message != nullptr ? message : "it has no device here"));
  return std::nullopt;
}

}  // namespace etendue
