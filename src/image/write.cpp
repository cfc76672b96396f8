#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>

#include "base/error.h"
#include "base/output_file.h"
#include "image/io.h"

namespace etendue {
namespace {

struct Format {
  std::string_view extension;
  const char* encoder;  ///< OpenImageIO's name
  int longest_side = std::numeric_limits<int>::max();
};

/// libjpeg ends the process on more than this, so it must not be asked.
constexpr int kLongestJpegSide = 65500;

constexpr std::array kFormats = {Format{".png", "png"},
                                 Format{".jpg", "jpeg", kLongestJpegSide},
                                 Format{".jpeg", "jpeg", kLongestJpegSide},
                                 Format{".tif", "tiff"},
                                 Format{".tiff", "tiff"},
                                 Format{".exr", "openexr"},
                                 Format{".hdr", "hdr"}};

/// The brightest value that an RGBE pixel's exponent byte can hold.
constexpr float kBrightestRgbe = 0x1.fep126f;

const Format& format_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const Format& format : kFormats)
    if (format.extension == extension) return format;
  std::string known;
  for (const Format& format : kFormats) known += fmt::format(" {}", format.extension);
  throw Error(Failure::usage, fmt::format("cannot write {}: the ending of its name says no format; choose one of{}",
                                          path.string(), known));
}

/// The format for a picture of this size. Throws Error(Failure::usage).
const Format& format_for(const std::filesystem::path& path, int width, int height) {
  const Format& format = format_of(path);
  if (std::max(width, height) > format.longest_side)
    throw Error(Failure::usage,
                fmt::format("cannot write {}: the picture has {} x {} pixels, and a {} at most {} a side; choose "
                            "another format",
                            path.string(), width, height, format.extension, format.longest_side));
  return format;
}

/// Limits a value to [0, most]; NaN becomes 0.
float clamp_positive(float value, float most) {
  return value > 0 ? std::min(value, most) : 0.0f;
}

std::uint8_t to_srgb_byte(float linear) {
  return static_cast<std::uint8_t>(std::lround(255.0f * linear_to_srgb(clamp_positive(linear, 1.0f))));
}

/// Encodes one picture into memory.
class Encoder {
 public:
  Encoder(const Format& format, OIIO::ImageSpec spec) : spec_(std::move(spec)) {
    output_ = OIIO::ImageOutput::create(format.encoder);
    if (!output_) throw std::runtime_error(OIIO::geterror());
    output_->set_ioproxy(&memory_);
    require(output_->open(fmt::format("picture{}", format.extension), spec_));
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  /// `value(channel, pixel)` for every channel of every pixel, row after row.
  template <typename Value>
  void write(const Value& value) {
    using Number = decltype(value(0, std::size_t{0}));
    constexpr int kRowsAtOnce = 64;  // enough for the encoder's threads, little memory
    const std::size_t channels = static_cast<std::size_t>(spec_.nchannels);
    std::vector<Number> rows;
    for (int begin = 0; begin < spec_.height; begin += kRowsAtOnce) {
      const int end = std::min(begin + kRowsAtOnce, spec_.height);
      const std::size_t first = static_cast<std::size_t>(begin) * spec_.width;
      const std::size_t count = static_cast<std::size_t>(end - begin) * spec_.width;
      rows.resize(count * channels);
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < channels; ++c) rows[i * channels + c] = value(static_cast<int>(c), first + i);
      require(output_->write_scanlines(begin, end, 0, OIIO::BaseTypeFromC<Number>::value, rows.data()));
    }
  }

  std::span<const std::byte> finish() {
    require(output_->close());
    return std::as_bytes(std::span(memory_.buffer()));
  }

 private:
  void require(bool success) {
    if (!success) throw std::runtime_error(output_->geterror());
  }

  OIIO::ImageSpec spec_;
  OIIO::Filesystem::IOVecOutput memory_;
  std::unique_ptr<OIIO::ImageOutput> output_;
};

OIIO::ImageSpec float_spec(const Image& image) {
  return {image.width(), image.height(), 3, OIIO::TypeDesc::FLOAT};
}

void encode_display(Encoder& encoder, const Image& image, const ToneMapping& tone) {
  const float exposure = std::exp2(tone.exposure_stops);
  encoder.write(
      [&](int channel, std::size_t pixel) { return to_srgb_byte(image.pixels()[pixel][channel] * exposure); });
}

/// The attribute that a metadata key is stored under: keys without a namespace get ours.
std::string attribute_name(const std::string& key) {
  return key.find(':') == std::string::npos ? "etendue:" + key : key;
}

OIIO::ImageSpec exr_spec(const Picture& picture) {
  OIIO::ImageSpec spec = float_spec(picture.beauty);
  spec.channelnames = {"R", "G", "B"};
  for (const Channel& channel : picture.channels) spec.channelnames.push_back(channel.name);
  spec.nchannels = static_cast<int>(spec.channelnames.size());
  spec.attribute("compression", "zip");
  for (const auto& [key, value] : picture.metadata) spec.attribute(attribute_name(key), value);
  return spec;
}

void encode_layers(Encoder& encoder, const Picture& picture) {
  encoder.write([&](int channel, std::size_t pixel) {
    return channel < 3 ? picture.beauty.pixels()[pixel][channel] : picture.channels[channel - 3].values[pixel];
  });
}

void write_encoded(const std::filesystem::path& path, const Format& format, const Picture& picture,
                   const ToneMapping& tone) {
  const Image& image = picture.beauty;
  const std::string_view name = format.encoder;
  OIIO::ImageSpec spec = name == "openexr" ? exr_spec(picture) : float_spec(image);
  if (name == "png" || name == "jpeg") {
    spec.set_format(OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
  }
  if (name == "jpeg") {
    spec.attribute("Compression", "jpeg:95");
    spec.attribute("jpeg:subsampling", "4:4:4");
  }
  Encoder encoder(format, spec);
  if (name == "png" || name == "jpeg")
    encode_display(encoder, image, tone);
  else if (name == "openexr")
    encode_layers(encoder, picture);
  else if (name == "hdr")
    encoder.write([&](int c, std::size_t pixel) { return clamp_positive(image.pixels()[pixel][c], kBrightestRgbe); });
  else
    encoder.write([&](int c, std::size_t pixel) { return image.pixels()[pixel][c]; });
  write_whole_file(path, encoder.finish());
}

void require_consistent(const Picture& picture) {
  if (picture.beauty.empty()) throw Error(Failure::internal, "a picture without pixels cannot be written");
  for (const Channel& channel : picture.channels)
    if (channel.values.size() != picture.beauty.pixels().size())
      throw Error(Failure::internal, fmt::format("channel {} has {} values for {} pixels", channel.name,
                                                 channel.values.size(), picture.beauty.pixels().size()));
}

}  // namespace

void write_picture(const std::filesystem::path& path, const Picture& picture, const ToneMapping& tone) {
  const Format& format = format_for(path, picture.beauty.width(), picture.beauty.height());
  require_consistent(picture);
  try {
    write_encoded(path, format, picture, tone);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(Failure::output, fmt::format("cannot write {} as {}: {}; choose another format", path.string(),
                                             format.extension, e.what()));
  }
}

void check_writable(const std::filesystem::path& path, int width, int height) {
  format_for(path, width, height);
  check_file_writable(path);
}

}  // namespace etendue
