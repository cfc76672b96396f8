#include "denoise/plane.h"

#include <algorithm>

namespace etendue {
namespace {

/// `i` reflected into [0, size), the border pixel not repeated.
int reflected(int i, int size) {
  if (size == 1) return 0;
  const int period = 2 * (size - 1), within = ((i % period) + period) % period;
  return std::min(within, period - within);
}

}  // namespace

void Plane::mirror() {
  for (int y = 0; y < height_; ++y) {
    float* const values = row(y);
    for (int i = 1; i <= kMargin; ++i) values[-i] = values[reflected(-i, width_)];
    for (int i = width_; i < width_ + kMargin + kLanes; ++i) values[i] = values[reflected(i, width_)];
  }
  const auto copy_row = [&](int to, int from) { std::copy_n(row(from) - kMargin, stride_, row(to) - kMargin); };
  for (int i = 1; i <= kMargin; ++i) {
    copy_row(-i, reflected(-i, height_));
    copy_row(height_ - 1 + i, reflected(height_ - 1 + i, height_));
  }
}

Plane box_blurred(const Plane& plane, int radius) {
  const float scale = 1.0f / static_cast<float>(2 * radius + 1);
  const Plane along_rows = make_plane(plane.width(), plane.height(), [&](int x, int y) {
    float sum = 0;
    for (int i = -radius; i <= radius; ++i) sum += plane.row(y)[x + i];
    return sum * scale;
  });
  return make_plane(plane.width(), plane.height(), [&](int x, int y) {
    float sum = 0;
    for (int i = -radius; i <= radius; ++i) sum += along_rows.row(y + i)[x];
    return sum * scale;
  });
}

}  // namespace etendue
