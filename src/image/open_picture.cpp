#include "image/open_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>

namespace etendue {
namespace {

constexpr int kMostChannels = 1024;
/// How many bytes of picture a byte of file can be at most: well above what any lossless format packs into it.
constexpr std::uint64_t kMostExpansion = 1 << 16;

void require_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) cannot_read(path, "there is no such file");
  if (error) cannot_read(path, error.message());
  if (std::filesystem::is_directory(status)) cannot_read(path, "it is a folder, not a picture");
  if (!std::filesystem::is_regular_file(status)) cannot_read(path, "it is not a file");
  if (std::filesystem::file_size(path) == 0) cannot_read(path, "the file is empty");
}

void require_sane(const std::filesystem::path& path, const OIIO::ImageSpec& spec, std::uint64_t most_pixels) {
  if (spec.deep || spec.depth > 1) cannot_read(path, "deep pictures and volumes are not read; please flatten it");
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0)
    cannot_read(path, fmt::format("its size is {} × {} pixels with {} channels; the file is damaged", spec.width,
                                  spec.height, spec.nchannels));
  const std::uint64_t pixels = static_cast<std::uint64_t>(spec.width) * static_cast<std::uint64_t>(spec.height);
  if (pixels > most_pixels || spec.nchannels > kMostChannels)
    cannot_read(
        path,
        fmt::format("{} × {} pixels with {} channels are more than the {} million pixels and {} channels that are read",
                    spec.width, spec.height, spec.nchannels, most_pixels >> 20, kMostChannels));
  const std::uint64_t file_bytes = std::filesystem::file_size(path);
  if (spec.image_bytes() / kMostExpansion > file_bytes)
    cannot_read(path, fmt::format("it claims {} × {} pixels but has only {} bytes; the file is damaged or cut off",
                                  spec.width, spec.height, file_bytes));
}

/// The decoder fills in grey for the missing part of a JPEG file and says nothing. Coded data has no markers, so a
/// whole file has an end marker (FF D9) after its last start-of-scan marker (FF DA).
void require_jpeg_end(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::size_t scan = bytes.rfind("\xff\xda");
  if (scan == std::string::npos || bytes.find("\xff\xd9", scan) == std::string::npos)
    cannot_read(path, "the file is cut off (the end of the JPEG data is missing)");
}

}  // namespace

void cannot_read(const std::filesystem::path& path, const std::string& reason) {
  throw Error(Failure::input, fmt::format("cannot read {}: {}", path.string(), reason));
}

std::string short_quote(std::string text) {
  constexpr std::size_t kLongest = 160;
  text = text.substr(0, text.find('\n'));
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "…";
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text.empty() ? "no reason given" : text;
}

OpenPicture::OpenPicture(const std::filesystem::path& path, std::uint64_t most_pixels) : path_(path) {
  require_file(path);
  OIIO::ImageSpec configuration;
  configuration.attribute("oiio:UnassociatedAlpha", 1);  // colours as they are stored, not multiplied by alpha
  input_ = OIIO::ImageInput::open(path.string(), &configuration);
  // OpenImageIO's reader "null" makes up a picture for anything with its ending.
  if (!input_ || format() == "null")
    cannot_read(path,
                fmt::format("it is not a picture of a known format, or damaged ({})", short_quote(OIIO::geterror())));
  if (format() == "jpeg") require_jpeg_end(path);
  require_sane(path, spec(), most_pixels);
}

template <typename T>
std::vector<T> OpenPicture::read(int begin, int end) {
  std::vector<T> values(pixel_count() * (end - begin));
  // A reader may return true although it noted that strips are missing.
  if (!input_->read_image(0, 0, begin, end, OIIO::BaseTypeFromC<T>::value, values.data()) || input_->has_error())
    cannot_read(path_, fmt::format("the file is damaged or cut off ({})", short_quote(input_->geterror())));
  return values;
}

template std::vector<float> OpenPicture::read<float>(int, int);
template std::vector<std::uint8_t> OpenPicture::read<std::uint8_t>(int, int);

std::array<int, 3> color_channels(const OIIO::ImageSpec& spec) {
  const std::array named = {spec.channelindex("R"), spec.channelindex("G"), spec.channelindex("B")};
  if (std::ranges::none_of(named, [](int index) { return index < 0; })) return named;
  return spec.nchannels < 3 ? std::array{0, 0, 0} : std::array{0, 1, 2};
}

}  // namespace etendue
