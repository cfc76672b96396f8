#include "image/texels.h"

#include <OpenImageIO/imagecache.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "image/open_picture.h"

namespace etendue {
namespace {

constexpr int kTileSide = 64;
constexpr float kCacheMegabytes = 1024;

/// What a byte means.
const float* byte_table(ColorEncoding encoding) {
  static const auto make = [](auto&& decode) {
    std::array<float, 256> table;
    for (int i = 0; i < 256; ++i) table[i] = decode(static_cast<float>(i) / 255.0f);
    return table;
  };
  static const std::array<float, 256> linear = make([](float x) { return x; });
  static const std::array<float, 256> srgb = make(srgb_to_linear);
  return encoding == ColorEncoding::srgb ? srgb.data() : linear.data();
}

/// The cache that all pictures share.
OIIO::ImageCache& tile_cache() {
  static const std::shared_ptr<OIIO::ImageCache> cache = [] {
    std::shared_ptr<OIIO::ImageCache> made(OIIO::ImageCache::create(false),
                                           [](OIIO::ImageCache* c) { OIIO::ImageCache::destroy(c); });
    made->attribute("max_memory_MB", kCacheMegabytes);
    made->attribute("autotile", kTileSide);
    made->attribute("unassociatedalpha", 1);
    made->attribute("forcefloat", 1);
    return made;
  }();
  return *cache;
}

}  // namespace

/// A picture on disk.
class Texels::Tiles {
 public:
  Tiles(const std::filesystem::path& path, const OIIO::ImageSpec& spec, ColorEncoding encoding)
      : name_(path.string()),
        channels_(color_channels(spec)),
        decode_(encoding == ColorEncoding::srgb && !spec.format.is_floating_point()) {}

  Spectrum at(int x, int y) const {
    OIIO::ImageCache& cache = tile_cache();
    OIIO::ImageCache::Tile* tile = cache.get_tile(name_, 0, 0, x, y, 0);
    if (tile == nullptr)
      return Spectrum(std::numeric_limits<float>::quiet_NaN());  // the file vanished: counted as an invalid sample
    OIIO::TypeDesc type;
    const auto* values = static_cast<const float*>(cache.tile_pixels(tile, type));
    const OIIO::ROI roi = cache.tile_roi(tile);
    const auto texel = static_cast<std::size_t>(y - roi.ybegin) * roi.width() + (x - roi.xbegin);
    Spectrum color;
    for (int c = 0; c < 3; ++c) color[c] = values[texel * roi.nchannels() + channels_[c]];
    cache.release_tile(tile);
    if (decode_)
      for (int c = 0; c < 3; ++c) color[c] = srgb_to_linear(color[c]);
    return color;
  }

 private:
  OIIO::ustring name_;
  std::array<int, 3> channels_;
  bool decode_;
};

Spectrum Texels::at(int x, int y) const {
  if (const auto* bytes = std::get_if<Bytes>(&store_)) {
    const std::uint8_t* texel = bytes->values.data() + 3 * (static_cast<std::size_t>(y) * width_ + x);
    return {bytes->decode[texel[0]], bytes->decode[texel[1]], bytes->decode[texel[2]]};
  }
  if (const auto* image = std::get_if<Image>(&store_)) return image->at(x, y);
  return std::get<std::shared_ptr<const Tiles>>(store_)->at(x, y);
}

std::size_t Texels::clamp(float maximum) {
  auto* image = std::get_if<Image>(&store_);
  if (image == nullptr) return 0;
  std::size_t changed = 0;
  for (Spectrum& texel : image->pixels()) {
    const Spectrum before = texel;
    for (int c = 0; c < 3; ++c) texel[c] = texel[c] >= 0 ? std::min(texel[c], maximum) : 0.0f;
    changed += texel == before ? 0 : 1;
  }
  return changed;
}

Texels read_texels(const std::filesystem::path& path, ColorEncoding encoding, std::uint64_t most_in_memory) {
  return guarded_read(path, [&] {
    OpenPicture picture(path, std::numeric_limits<std::uint64_t>::max());
    const OIIO::ImageSpec& spec = picture.spec();
    if (picture.pixel_count() > most_in_memory)
      return Texels(spec.width, spec.height, std::make_shared<const Texels::Tiles>(path, spec, encoding));
    if (spec.format != OIIO::TypeDesc::UINT8) return Texels(read_image(path, encoding));

    const std::array<int, 3> colors = color_channels(spec);
    const int begin = std::ranges::min(colors), end = std::ranges::max(colors) + 1;
    std::vector<std::uint8_t> values = picture.read<std::uint8_t>(begin, end);
    if (colors != std::array{begin, begin + 1, begin + 2}) {
      std::vector<std::uint8_t> gathered(3 * picture.pixel_count());
      for (std::size_t i = 0; i < picture.pixel_count(); ++i)
        for (int c = 0; c < 3; ++c) gathered[3 * i + c] = values[i * (end - begin) + (colors[c] - begin)];
      values = std::move(gathered);
    }
    return Texels(spec.width, spec.height, Texels::Bytes{std::move(values), byte_table(encoding)});
  });
}

}  // namespace etendue
