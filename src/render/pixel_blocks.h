#pragma once

#include <algorithm>
#include <cstdint>

#include "render/integrator.h"
#include "render/settings.h"
#include "sampling/hash.h"

namespace etendue {

/// How the picture's pixels are divided into blocks that are estimated together. The grid moves from generation to
/// generation, so that what a block's pixels have in common does not stay where it is.
class PixelBlocks {
 public:
  PixelBlocks(int block_side, const RenderSettings& settings, const CropWindow& seen)
      : side_(block_side), width_(settings.width), height_(settings.height), window_(seen) {}

  void move(std::uint32_t generation) {
    const std::uint32_t hash = generation == 0 ? 0 : mix_bits(generation);
    offset_x_ = static_cast<int>(hash & 0xffffu) % side_;
    offset_y_ = static_cast<int>(hash >> 16) % side_;
  }

  int side() const { return side_; }  ///< of a block, in pixels
  /// Of the blocks that the window shows some of.
  int columns() const { return (window_.x + window_.width - 1 + offset_x_) / side_ - first_column() + 1; }
  int rows() const { return (window_.y + window_.height - 1 + offset_y_) / side_ - first_row() + 1; }

  /// In pixels of the whole picture, and within it; maybe not all within the window.
  PixelBlock block(int column, int row) const {
    const int x = (first_column() + column) * side_ - offset_x_, y = (first_row() + row) * side_ - offset_y_;
    const int x0 = std::max(x, 0), y0 = std::max(y, 0);
    return {x0, y0, std::min(x + side_, width_) - x0, std::min(y + side_, height_) - y0};
  }

 private:
  int first_column() const { return (window_.x + offset_x_) / side_; }
  int first_row() const { return (window_.y + offset_y_) / side_; }

  int side_, width_, height_;
  CropWindow window_;
  int offset_x_ = 0, offset_y_ = 0;
};

}  // namespace etendue
