#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "math/spectrum.h"

namespace etendue {

/// A picture of `width` × `height` pixels with three linear Rec. 709 channels; row 0 is the top.
class Image {
 public:
  Image() = default;
  Image(int width, int height, Spectrum fill = {})
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height, fill) {}

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }

  Spectrum& at(int x, int y) { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }
  const Spectrum& at(int x, int y) const { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }
  std::span<Spectrum> pixels() { return pixels_; }
  std::span<const Spectrum> pixels() const { return pixels_; }

 private:
  int width_ = 0, height_ = 0;
  std::vector<Spectrum> pixels_;
};

/// A named plane of floats beside the picture (an AOV): "depth.Z", "albedo.R", …; one value per pixel, row 0 on top.
struct Channel {
  std::string name;
  std::vector<float> values;
};

/// What a renderer gives out: the picture, its named channels and the key–value pairs that say what made it.
struct Picture {
  Image beauty;
  std::vector<Channel> channels;
  std::map<std::string, std::string> metadata;
};

}  // namespace etendue
