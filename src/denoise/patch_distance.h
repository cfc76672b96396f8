#pragma once

#include <functional>
#include <span>
#include <vector>

#include "denoise/plane.h"

namespace etendue {

/// A channel of the picture that tells which pixels resemble each other, and the variance of its values.
struct GuideChannel {
  const Plane* value;
  const Plane* variance;
};

/// The square of (2·radius + 1)² pixels around a pixel that is looked through, by patches of (2·patch + 1)². Together
/// they fit into a plane's margin.
struct Window {
  int radius, patch;

  int side() const { return 2 * radius + 1; }
  int offsets() const { return side() * side(); }
  int dx(int offset) const { return offset % side() - radius; }
  int dy(int offset) const { return offset / side() - radius; }
};

/// A part of the picture that is worked on in one go.
struct Tile {
  static constexpr int kWidth = 64, kHeight = 16;

  int x, y;           ///< its upper left pixel
  int width, height;  ///< of what lies in the picture; the width rounded up to whole Lanes
};

/// Calls `body` for the tiles of a picture, on the machine's threads.
void for_each_tile(int width, int height, const std::function<void(const Tile&)>& body);

/// How far the patch around a tile's pixel p and that around its neighbour q are apart, in units of their noise, whose
/// own share is taken off (Rousselle, Knaus and Zwicker 2012, eqs. 3–5, without their k):
///
///   d² = mean over patch and channels of ((u_p − u_q)² − (v_p + min(v_p, v_q))) / (ε + v_p + v_q)
///
/// About 0 or less for patches that differ by noise only. A neighbour's large variance alone makes it no more alike.
class PatchDistances {
 public:
  PatchDistances(const Window& window, std::span<const GuideChannel> guide, const Tile& tile);

  /// Between the kLanes pixels that begin at (x, y) of the tile and their neighbours at an offset of the window.
  const float* at(int offset, int x, int y) const { return &values_[offset * kSize + y * Tile::kWidth + x]; }

 private:
  static constexpr std::size_t kSize = static_cast<std::size_t>(Tile::kWidth) * Tile::kHeight;

  std::vector<float> values_;
};

}  // namespace etendue
