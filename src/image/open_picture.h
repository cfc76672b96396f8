#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

/// Reading within this room: what read.cpp and texels.cpp share.
namespace etendue {

[[noreturn]] void cannot_read(const std::filesystem::path& path, const std::string& reason);

/// A library's message, fit for quoting within a sentence: one line, not long, no full stop.
std::string short_quote(std::string text);

/// A picture file whose header was read and found sane.
class OpenPicture {
 public:
  /// Throws Error(Failure::input); also if it has more than `most_pixels`.
  OpenPicture(const std::filesystem::path& path, std::uint64_t most_pixels);

  std::string_view format() const { return input_->format_name(); }
  const OIIO::ImageSpec& spec() const { return input_->spec(); }
  std::size_t pixel_count() const { return static_cast<std::size_t>(spec().width) * spec().height; }

  /// Channels [begin, end) of all pixels, interleaved, as T: float (integers scaled to [0, 1]) or std::uint8_t.
  template <typename T>
  std::vector<T> read(int begin, int end);

 private:
  std::filesystem::path path_;
  std::unique_ptr<OIIO::ImageInput> input_;
};

/// Which channels are red, green and blue: those of that name, else the first three; of grey pictures the only one.
std::array<int, 3> color_channels(const OIIO::ImageSpec& spec);

/// Runs `read`; whatever a decoder throws becomes an Error that names the file.
template <typename Read>
auto guarded_read(const std::filesystem::path& path, Read read) {
  try {
    return read();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    cannot_read(path, short_quote(e.what()));
  }
}

}  // namespace etendue
