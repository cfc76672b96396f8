#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>

#include "base/error.h"
#include "image/io.h"

namespace etendue {
namespace {

/// More pixels than any picture in use (a map of 16384 × 8192 is the limit); beyond it a size is taken for damage.
constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 27;
constexpr int kMostChannels = 1024;
/// How many bytes of picture a byte of file can be at most: well above what any lossless format packs into it.
constexpr std::uint64_t kMostExpansion = 1 << 16;
constexpr std::string_view kOurPrefix = "etendue:";

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& reason) {
  throw Error(Failure::input, fmt::format("cannot read {}: {}", path.string(), reason));
}

/// A library's message, fit for quoting within a sentence: one line, not long, no full stop.
std::string short_quote(std::string text) {
  constexpr std::size_t kLongest = 160;
  text = text.substr(0, text.find('\n'));
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "…";
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text.empty() ? "no reason given" : text;
}

void require_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) fail(path, "there is no such file");
  if (error) fail(path, error.message());
  if (std::filesystem::is_directory(status)) fail(path, "it is a folder, not a picture");
  if (!std::filesystem::is_regular_file(status)) fail(path, "it is not a file");
  if (std::filesystem::file_size(path) == 0) fail(path, "the file is empty");
}

void require_sane(const std::filesystem::path& path, const OIIO::ImageSpec& spec) {
  if (spec.deep || spec.depth > 1) fail(path, "deep pictures and volumes are not read; please flatten it");
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0)
    fail(path, fmt::format("its size is {} × {} pixels with {} channels; the file is damaged", spec.width, spec.height,
                           spec.nchannels));
  const std::uint64_t pixels = static_cast<std::uint64_t>(spec.width) * static_cast<std::uint64_t>(spec.height);
  if (pixels > kMostPixels || spec.nchannels > kMostChannels)
    fail(path, fmt::format(
                   "{} × {} pixels with {} channels are more than the {} million pixels and {} channels that are read",
                   spec.width, spec.height, spec.nchannels, kMostPixels >> 20, kMostChannels));
  const std::uint64_t file_bytes = std::filesystem::file_size(path);
  if (spec.image_bytes() / kMostExpansion > file_bytes)
    fail(path, fmt::format("it claims {} × {} pixels but has only {} bytes; the file is damaged or cut off", spec.width,
                           spec.height, file_bytes));
}

/// The decoder fills in grey for the missing part of a JPEG file and says nothing. Coded data has no markers, so a
/// whole file has an end marker (FF D9) after its last start-of-scan marker (FF DA).
void require_jpeg_end(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::size_t scan = bytes.rfind("\xff\xda");
  if (scan == std::string::npos || bytes.find("\xff\xd9", scan) == std::string::npos)
    fail(path, "the file is cut off (the end of the JPEG data is missing)");
}

/// A picture file whose header was read and found sane.
class OpenPicture {
 public:
  explicit OpenPicture(const std::filesystem::path& path) : path_(path) {
    require_file(path);
    OIIO::ImageSpec configuration;
    configuration.attribute("oiio:UnassociatedAlpha", 1);  // colours as they are stored, not multiplied by alpha
    input_ = OIIO::ImageInput::open(path.string(), &configuration);
    // OpenImageIO's reader "null" makes up a picture for anything with its ending.
    if (!input_ || format() == "null")
      fail(path, fmt::format("it is not a picture of a known format, or damaged ({})", short_quote(OIIO::geterror())));
    if (format() == "jpeg") require_jpeg_end(path);
    require_sane(path, spec());
  }

  std::string_view format() const { return input_->format_name(); }
  const OIIO::ImageSpec& spec() const { return input_->spec(); }
  std::size_t pixel_count() const { return static_cast<std::size_t>(spec().width) * spec().height; }

  /// Channels [begin, end) of all pixels, interleaved; integers scaled to [0, 1].
  std::vector<float> read(int begin, int end) {
    std::vector<float> values(pixel_count() * (end - begin));
    // A reader may return true although it noted that strips are missing.
    if (!input_->read_image(0, 0, begin, end, OIIO::TypeDesc::FLOAT, values.data()) || input_->has_error())
      fail(path_, fmt::format("the file is damaged or cut off ({})", short_quote(input_->geterror())));
    return values;
  }

 private:
  std::filesystem::path path_;
  std::unique_ptr<OIIO::ImageInput> input_;
};

/// Which channels are red, green and blue: those of that name, else the first three; of grey pictures the only one.
std::array<int, 3> color_channels(const OIIO::ImageSpec& spec) {
  const std::array named = {spec.channelindex("R"), spec.channelindex("G"), spec.channelindex("B")};
  if (std::ranges::none_of(named, [](int index) { return index < 0; })) return named;
  return spec.nchannels < 3 ? std::array{0, 0, 0} : std::array{0, 1, 2};
}

Image gather(const OIIO::ImageSpec& spec, const std::vector<float>& values, int stride,
             const std::array<int, 3>& offsets) {
  Image image(spec.width, spec.height);
  for (std::size_t i = 0; i < image.pixels().size(); ++i)
    for (int c = 0; c < 3; ++c) image.pixels()[i][c] = values[i * stride + offsets[c]];
  return image;
}

/// Decodes in place what came from 8- or 16-bit integers, exactly, by table.
void decode_srgb(Image& image) {
  static const std::vector<float> table = [] {
    std::vector<float> made(65536);
    for (std::size_t i = 0; i < made.size(); ++i) made[i] = srgb_to_linear(static_cast<float>(i) / 65535.0f);
    return made;
  }();
  for (Spectrum& pixel : image.pixels())
    for (int c = 0; c < 3; ++c)
      pixel[c] = table[static_cast<std::size_t>(std::lround(std::clamp(pixel[c], 0.0f, 1.0f) * 65535.0f))];
}

/// Runs `read`; whatever a decoder throws becomes an Error that names the file.
template <typename Read>
auto guarded(const std::filesystem::path& path, Read read) {
  try {
    return read();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    fail(path, short_quote(e.what()));
  }
}

std::map<std::string, std::string> metadata_of(const OIIO::ImageSpec& spec) {
  std::map<std::string, std::string> metadata;
  for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
    const std::string name = attribute.name().string();
    if (attribute.type() != OIIO::TypeDesc::STRING || name.find(':') == std::string::npos) continue;
    if (name.starts_with("oiio:") || name.starts_with("openexr:")) continue;
    metadata[name.starts_with(kOurPrefix) ? name.substr(kOurPrefix.size()) : name] = attribute.get_string();
  }
  return metadata;
}

}  // namespace

Image read_image(const std::filesystem::path& path, ColorEncoding encoding) {
  return guarded(path, [&] {
    OpenPicture picture(path);
    const std::array<int, 3> colors = color_channels(picture.spec());
    const int begin = std::min({colors[0], colors[1], colors[2]});
    const int end = std::max({colors[0], colors[1], colors[2]}) + 1;
    Image image = gather(picture.spec(), picture.read(begin, end), end - begin,
                         {colors[0] - begin, colors[1] - begin, colors[2] - begin});
    if (encoding == ColorEncoding::srgb && !picture.spec().format.is_floating_point()) decode_srgb(image);
    return image;
  });
}

Picture read_picture(const std::filesystem::path& path) {
  return guarded(path, [&] {
    OpenPicture file(path);
    const OIIO::ImageSpec& spec = file.spec();
    const std::vector<float> values = file.read(0, spec.nchannels);
    const std::array<int, 3> colors = color_channels(spec);
    Picture picture{gather(spec, values, spec.nchannels, colors), {}, metadata_of(spec)};
    if (!spec.format.is_floating_point()) decode_srgb(picture.beauty);
    for (int c = 0; c < spec.nchannels; ++c) {
      if (std::ranges::find(colors, c) != colors.end()) continue;
      Channel& channel =
          picture.channels.emplace_back(Channel{spec.channel_name(c), std::vector<float>(file.pixel_count())});
      for (std::size_t i = 0; i < channel.values.size(); ++i) channel.values[i] = values[i * spec.nchannels + c];
    }
    return picture;
  });
}

}  // namespace etendue
