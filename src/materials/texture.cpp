#include "materials/texture.h"

namespace etendue {
namespace {

int wrap(int i, int n) {
  const int r = i % n;
  return r < 0 ? r + n : r;
}

}  // namespace

Spectrum lookup_texture(const Image& image, Vec2 uv) {
  const float u = uv.x - std::floor(uv.x), v = uv.y - std::floor(uv.y);
  if (!std::isfinite(u) || !std::isfinite(v)) return image.at(0, 0);
  const float x = u * static_cast<float>(image.width()) - 0.5f, y = (1 - v) * static_cast<float>(image.height()) - 0.5f;
  const float fx = std::floor(x), fy = std::floor(y);
  const int x0 = wrap(static_cast<int>(fx), image.width()), y0 = wrap(static_cast<int>(fy), image.height());
  const int x1 = wrap(x0 + 1, image.width()), y1 = wrap(y0 + 1, image.height());
  const float dx = x - fx, dy = y - fy;
  return (image.at(x0, y0) * (1 - dx) + image.at(x1, y0) * dx) * (1 - dy) +
         (image.at(x0, y1) * (1 - dx) + image.at(x1, y1) * dx) * dy;
}

}  // namespace etendue
