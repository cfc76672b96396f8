#include "materials/texture.h"

namespace etendue {
namespace {

/// Index i brought into [0, n).
int wrapped(int i, int n, TexelWrap wrap) {
  switch (wrap) {
    case TexelWrap::clamp:
      return std::clamp(i, 0, n - 1);
    case TexelWrap::repeat: {
      const int r = i % n;
      return r < 0 ? r + n : r;
    }
    case TexelWrap::mirror: {
      int r = i % (2 * n);
      if (r < 0) r += 2 * n;
      return r < n ? r : 2 * n - 1 - r;
    }
  }
  return 0;
}

/// Coordinates so large that floats hold no fraction count as their nearest: nothing finer is known, and integers do
/// not overflow.
float within_reach(float x) {
  constexpr float kReach = 0x1p24f;
  return std::isfinite(x) ? std::clamp(x, -kReach, kReach) : 0.0f;
}

/// The four texels around a point of the picture, and where it lies between them.
struct Cell {
  Spectrum texel[2][2];  ///< [row][column], rows downwards
  float dx, dy;
};

Cell cell_at(const BitmapTexture& texture, Vec2 uv) {
  const int width = texture.texels.width(), height = texture.texels.height();
  // Whole repetitions are taken off first, so that far coordinates keep their precision.
  const float period = texture.wrap == TexelWrap::mirror ? 2.0f : 1.0f;
  if (texture.wrap != TexelWrap::clamp)
    uv = {uv.x - period * std::floor(uv.x / period), uv.y - period * std::floor(uv.y / period)};
  const float x = within_reach(uv.x * static_cast<float>(width) - 0.5f);
  const float y = within_reach((1 - uv.y) * static_cast<float>(height) - 0.5f);
  const float fx = std::floor(x), fy = std::floor(y);
  const int x0 = wrapped(static_cast<int>(fx), width, texture.wrap),
            x1 = wrapped(static_cast<int>(fx) + 1, width, texture.wrap);
  const int y0 = wrapped(static_cast<int>(fy), height, texture.wrap),
            y1 = wrapped(static_cast<int>(fy) + 1, height, texture.wrap);
  const Texels& t = texture.texels;
  return {{{t.at(x0, y0), t.at(x1, y0)}, {t.at(x0, y1), t.at(x1, y1)}}, x - fx, y - fy};
}

struct Evaluator {
  const Textures& textures;
  const TexturePoint& point;

  Spectrum operator()(const BitmapTexture& t) const { return t.lookup(t.to_uv(point.uv)); }
  Spectrum operator()(const CheckerboardTexture& t) const {
    const Vec2 uv = t.to_uv(point.uv);
    const auto upper_half = [](float x) { return x - std::floor(x) > 0.5f; };
    return evaluate_color(upper_half(uv.x) == upper_half(uv.y) ? t.color0 : t.color1, textures, point);
  }
  Spectrum operator()(const AttributeTexture& t) const {
    if (point.geometry == nullptr) return Spectrum(0);
    return point.geometry->attribute(point.hit, t.attribute).value_or(Spectrum(0)) * t.scale;
  }
  Spectrum operator()(const VolumeTexture& t) const { return t.volume.lookup(point.position); }
};

}  // namespace

Spectrum BitmapTexture::lookup(Vec2 uv) const {
  const Cell cell = cell_at(*this, uv);
  if (filter == TexelFilter::nearest) return cell.texel[cell.dy < 0.5f ? 0 : 1][cell.dx < 0.5f ? 0 : 1];
  return (cell.texel[0][0] * (1 - cell.dx) + cell.texel[0][1] * cell.dx) * (1 - cell.dy) +
         (cell.texel[1][0] * (1 - cell.dx) + cell.texel[1][1] * cell.dx) * cell.dy;
}

Vec2 BitmapTexture::luminance_gradient(Vec2 uv) const {
  const Cell cell = cell_at(*this, uv);
  const auto l = [&](int row, int column) { return cell.texel[row][column].luminance(); };
  const float along_x = lerp(cell.dy, l(0, 1) - l(0, 0), l(1, 1) - l(1, 0)) * static_cast<float>(texels.width());
  const float down_y = lerp(cell.dx, l(1, 0) - l(0, 0), l(1, 1) - l(0, 1)) * static_cast<float>(texels.height());
  return {along_x, -down_y};
}

Spectrum evaluate_texture(const Textures& textures, std::uint32_t index, const TexturePoint& point) {
  return std::visit(Evaluator{textures, point}, textures[index]);
}

Vec2 luminance_gradient(const Textures& textures, std::uint32_t index, const TexturePoint& point) {
  const auto* bitmap = std::get_if<BitmapTexture>(&textures[index]);
  if (bitmap == nullptr || bitmap->filter == TexelFilter::nearest) return {0, 0};
  const Vec2 g = bitmap->luminance_gradient(bitmap->to_uv(point.uv));
  return {g.x * bitmap->to_uv.x.x + g.y * bitmap->to_uv.x.y, g.x * bitmap->to_uv.y.x + g.y * bitmap->to_uv.y.y};
}

}  // namespace etendue
