#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "image/io.h"
#include "image/open_picture.h"

namespace etendue {
namespace {

/// More pixels than any picture in use (a map of 16384 × 8192 is the limit); beyond it a size is taken for damage.
constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 27;
constexpr std::string_view kOurPrefix = "etendue:";

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
  return guarded_read(path, [&] {
    OpenPicture picture(path, kMostPixels);
    const std::array<int, 3> colors = color_channels(picture.spec());
    const int begin = std::min({colors[0], colors[1], colors[2]});
    const int end = std::max({colors[0], colors[1], colors[2]}) + 1;
    Image image = gather(picture.spec(), picture.read<float>(begin, end), end - begin,
                         {colors[0] - begin, colors[1] - begin, colors[2] - begin});
    if (encoding == ColorEncoding::srgb && !picture.spec().format.is_floating_point()) decode_srgb(image);
    return image;
  });
}

Picture read_picture(const std::filesystem::path& path) {
  return guarded_read(path, [&] {
    OpenPicture file(path, kMostPixels);
    const OIIO::ImageSpec& spec = file.spec();
    const std::vector<float> values = file.read<float>(0, spec.nchannels);
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
