#include "render/cascades.h"

#include <algorithm>
#include <cmath>

namespace etendue {
namespace {

/// From one cascade to the next, as a power of 2.
constexpr int kStep = 3;
/// The least luminance of the first, as a power of 2: what is darker is nobody's outlier.
constexpr int kDarkest = -9;
constexpr float kTrusted = 4;

/// Reconstruction filters have negative lobes.
float brightness(const Spectrum& sample) {
  return std::abs(sample.luminance());
}

}  // namespace

void Cascades::add(int x, int y, const Spectrum& sample) {
  const float bright = brightness(sample);
  if (!(bright >= std::ldexp(1.0f, kDarkest))) return;
  const int which = std::min((std::ilogb(bright) - kDarkest) / kStep, kCascades - 1);
  Cascade& cascade = pixels_[static_cast<std::size_t>(y) * width_ + x][which];
  cascade.sum += sample;
  ++cascade.samples;
}

/// Of the pixel and its neighbours, samples of a cascade or brighter ones. Those of the one before count for as much
/// less as they are darker.
float Cascades::samples_like(int x, int y, int cascade) const {
  const float least = std::ldexp(1.0f, kDarkest + kStep * cascade);
  float samples = 0;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height_ - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width_ - 1); ++u) {
      const Pixel& pixel = at(u, v);
      if (cascade > 0) samples += brightness(pixel[cascade - 1].sum) / least;
      for (int c = cascade; c < kCascades; ++c) samples += pixel[c].samples;
    }
  return samples;
}

Spectrum Cascades::doubtful(int x, int y) const {
  Spectrum sum;
  const Pixel& own = at(x, y);
  for (int cascade = 0; cascade < kCascades; ++cascade) {
    if (own[cascade].samples == 0) continue;
    const float trust = (samples_like(x, y, cascade) - 1) / (kTrusted - 1);
    sum += own[cascade].sum * (1 - std::clamp(trust, 0.0f, 1.0f));
  }
  return sum;
}

}  // namespace etendue
