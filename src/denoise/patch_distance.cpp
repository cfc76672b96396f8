#include "denoise/patch_distance.h"

#include <algorithm>

namespace etendue {
namespace {

/// Keeps differences between noise-free pixels finite.
constexpr float kLeastVariance = 1e-10f;

constexpr int kMostPatch = 3;

/// The distances of `count` single pixels along a row that begins at (x, y).
void pixel_distances(std::span<const GuideChannel> guide, int x, int y, int dx, int dy, int count, float* sum) {
  std::fill_n(sum, count, 0.0f);
  for (const GuideChannel& channel : guide) {
    const float* u_here = channel.value->row(y) + x;
    const float* u_there = channel.value->row(y + dy) + x + dx;
    const float* v_here = channel.variance->row(y) + x;
    const float* v_there = channel.variance->row(y + dy) + x + dx;
    for (int i = 0; i < count; ++i) {
      const float difference = u_here[i] - u_there[i];
      const float noise = v_here[i] + std::min(v_here[i], v_there[i]);
      sum[i] += (difference * difference - noise) / (kLeastVariance + v_here[i] + v_there[i]);
    }
  }
}

}  // namespace

void for_each_tile(int width, int height, const std::function<void(const Tile&)>& body) {
  const int columns = (width + Tile::kWidth - 1) / Tile::kWidth, rows = (height + Tile::kHeight - 1) / Tile::kHeight;
  parallel_for(static_cast<std::size_t>(columns) * rows, 1, [&](std::size_t begin, std::size_t end) {
    for (int i = static_cast<int>(begin); i < static_cast<int>(end); ++i) {
      const int x = i % columns * Tile::kWidth, y = i / columns * Tile::kHeight;
      const int whole_lanes = (width - x + kLanes - 1) / kLanes * kLanes;
      body({x, y, std::min(Tile::kWidth, whole_lanes), std::min(Tile::kHeight, height - y)});
    }
  });
}

PatchDistances::PatchDistances(const Window& window, std::span<const GuideChannel> guide, const Tile& tile)
    : values_(window.offsets() * kSize) {
  const int f = window.patch;
  const float scale = 1.0f / static_cast<float>((2 * f + 1) * (2 * f + 1) * static_cast<int>(guide.size()));
  float single[Tile::kWidth + 2 * kMostPatch];
  float along_rows[Tile::kHeight + 2 * kMostPatch][Tile::kWidth];
  for (int offset = 0; offset < window.offsets(); ++offset) {
    for (int r = 0; r < tile.height + 2 * f; ++r) {
      pixel_distances(guide, tile.x - f, tile.y - f + r, window.dx(offset), window.dy(offset), tile.width + 2 * f,
                      single);
      for (int x = 0; x < tile.width; ++x) {
        float sum = single[x];
        for (int i = 1; i <= 2 * f; ++i) sum += single[x + i];
        along_rows[r][x] = sum;
      }
    }
    float* out = &values_[offset * kSize];
    for (int y = 0; y < tile.height; ++y, out += Tile::kWidth)
      for (int x = 0; x < tile.width; ++x) {
        float sum = along_rows[y][x];
        for (int i = 1; i <= 2 * f; ++i) sum += along_rows[y + i][x];
        out[x] = sum * scale;
      }
  }
}

}  // namespace etendue
