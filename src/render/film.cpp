#include "render/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace etendue {

void PixelSums::add(const PixelSample& s) {
  const auto square_of = [](double x) { return x * x; };
  const Spectrum value = s.radiance * s.weight;
  for (int c = 0; c < 3; ++c) {
    sum[c] += value[c];
    sum_of_squares[c] += square_of(value[c]);
    albedo[c] += s.albedo[c];
  }
  luminance_squares += square_of(value.luminance());
  normal[0] += s.normal.x;
  normal[1] += s.normal.y;
  normal[2] += s.normal.z;
  depth += s.depth;
  hits += s.depth > 0 ? 1 : 0;
  ++samples;
}

double PixelSums::mean_luminance() const {
  return samples == 0 ? 0 : (0.2126 * sum[0] + 0.7152 * sum[1] + 0.0722 * sum[2]) / samples;
}

double PixelSums::luminance_error() const {
  if (samples < 2) return std::numeric_limits<double>::infinity();
  const double n = samples, mean = mean_luminance();
  const double variance = std::max(0.0, (luminance_squares - n * mean * mean) / (n - 1));
  return std::sqrt(variance / n);
}

Image Film::beauty() const {
  Image image(width(), height());
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const PixelSums& p = pixels_[i];
    const double scale = p.samples > 0 ? 1.0 / p.samples : 0.0;
    for (int c = 0; c < 3; ++c) image.pixels()[i][c] = static_cast<float>(p.sum[c] * scale);
  }
  return image;
}

Picture Film::picture() const {
  Picture picture;
  picture.beauty = beauty();
  const auto channel = [&](const char* name, auto&& value) {
    Channel out{name, {}};
    out.values.reserve(pixels_.size());
    for (const PixelSums& p : pixels_) out.values.push_back(static_cast<float>(p.samples > 0 ? value(p) : 0.0));
    picture.channels.push_back(std::move(out));
  };
  static constexpr const char* kAlbedo[] = {"albedo.R", "albedo.G", "albedo.B"};
  static constexpr const char* kNormal[] = {"normal.X", "normal.Y", "normal.Z"};
  static constexpr const char* kVariance[] = {"variance.R", "variance.G", "variance.B"};
  for (int c = 0; c < 3; ++c) channel(kAlbedo[c], [c](const PixelSums& p) { return p.albedo[c] / p.samples; });
  for (int c = 0; c < 3; ++c) channel(kNormal[c], [c](const PixelSums& p) { return p.normal[c] / p.samples; });
  channel("depth.Z", [](const PixelSums& p) { return p.hits > 0 ? p.depth / p.hits : 0.0; });
  channel("samples.N", [](const PixelSums& p) { return static_cast<double>(p.samples); });
  for (int c = 0; c < 3; ++c)
    channel(kVariance[c], [c](const PixelSums& p) {
      const double n = p.samples, mean = p.sum[c] / n;
      return n > 1 ? std::max(0.0, (p.sum_of_squares[c] - n * mean * mean) / (n - 1)) : 0.0;
    });
  return picture;
}

std::size_t Film::unsampled_pixels() const {
  return static_cast<std::size_t>(
      std::count_if(pixels_.begin(), pixels_.end(), [](const PixelSums& p) { return p.samples == 0; }));
}

double Film::noise() const {
  double sum = 0;
  for (const PixelSums& p : pixels_) sum += p.luminance_error() / (p.mean_luminance() + 0.01);
  return sum / static_cast<double>(pixels_.size());
}

}  // namespace etendue
