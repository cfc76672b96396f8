#pragma once

#include <memory>
#include <optional>

#include "image/image.h"

namespace etendue {

/// Intel's Open Image Denoise, version 1 or 2, where the machine has it: looked for while the program runs, so that
/// nothing needs it to be built.
class OpenImageDenoise {
 public:
  /// Nothing if the library is not there, or cannot be used.
  static std::optional<OpenImageDenoise> load();

  /// The picture without noise, by the filter for path-traced pictures, on the processor. If the library fails, it is
  /// told in a warning and there is no result.
  std::optional<Image> filter(const Image& color, const Image& albedo, const Image& normal) const;

 private:
  struct Library;
  explicit OpenImageDenoise(std::shared_ptr<const Library> library) : library_(std::move(library)) {}

  std::shared_ptr<const Library> library_;
};

}  // namespace etendue
