#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <variant>
#include <vector>

#include "image/image.h"
#include "image/io.h"

namespace etendue {

/// The texels of a picture of any size, as linear Rec. 709; row 0 is the top. Bytes are kept as bytes and decoded when
/// asked for. Pictures of more than kMostTexelsInMemory stay on disk: their tiles are read when needed and kept in
/// OpenImageIO's cache, all pictures together.
class Texels {
 public:
  static constexpr std::uint64_t kMostTexelsInMemory = std::uint64_t{1} << 26;

  explicit Texels(Image image) : width_(image.width()), height_(image.height()), store_(std::move(image)) {}

  int width() const { return width_; }
  int height() const { return height_; }
  /// 0 ≤ x < width, 0 ≤ y < height. Thread-safe.
  Spectrum at(int x, int y) const;
  /// Brings every channel of a float picture in memory into [0, maximum], NaN to 0; returns how many texels that
  /// changed.
  std::size_t clamp(float maximum);

 private:
  friend Texels read_texels(const std::filesystem::path& path, ColorEncoding encoding, std::uint64_t most_in_memory);

  struct Bytes {
    std::vector<std::uint8_t> values;  ///< three a texel
    const float* decode;               ///< 256 values
  };
  class Tiles;
  using Store = std::variant<Image, Bytes, std::shared_ptr<const Tiles>>;
  Texels(int width, int height, Store store) : width_(width), height_(height), store_(std::move(store)) {}

  int width_, height_;
  Store store_;
};

/// Opens a picture of any format OpenImageIO knows as read_image does, but of any size. Throws Error(Failure::input).
Texels read_texels(const std::filesystem::path& path, ColorEncoding encoding,
                   std::uint64_t most_in_memory = Texels::kMostTexelsInMemory);

}  // namespace etendue
