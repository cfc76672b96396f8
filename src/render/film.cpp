#include "render/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace etendue {
namespace {

void put(const PixelSums& pixel, std::size_t i, PictureHalf& half) {
  const double n = pixel.samples;
  for (int c = 0; c < 3; ++c) {
    half.color.pixels()[i][c] = static_cast<float>(pixel.sum[c] / n);
    half.variance.pixels()[i][c] = static_cast<float>(pixel.variance(c) / n);
    half.albedo.pixels()[i][c] = static_cast<float>(pixel.albedo[c] / n);
    half.normal.pixels()[i][c] = static_cast<float>(pixel.normal[c] / n);
  }
  half.depth[i] = static_cast<float>(pixel.hits > 0 ? pixel.depth / pixel.hits : 0.0);
}

}  // namespace

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

double PixelSums::variance(int channel) const {
  if (samples < 2) return 0;
  const double n = samples, mean = sum[channel] / n;
  return std::max(0.0, (sum_of_squares[channel] - n * mean * mean) / (n - 1));
}

PixelSums PixelSums::since(const PixelSums& earlier) const {
  PixelSums rest = *this;
  for (int c = 0; c < 3; ++c) {
    rest.sum[c] -= earlier.sum[c];
    rest.sum_of_squares[c] -= earlier.sum_of_squares[c];
    rest.albedo[c] -= earlier.albedo[c];
    rest.normal[c] -= earlier.normal[c];
  }
  rest.luminance_squares -= earlier.luminance_squares;
  rest.depth -= earlier.depth;
  rest.hits -= earlier.hits;
  rest.samples -= earlier.samples;
  return rest;
}

void Film::add(int x, int y, std::span<const PixelSample> samples, std::size_t in_first_half) {
  PixelSums& pixel = at(x, y);
  for (const PixelSample& sample : samples) pixel.add(sample);
  if (!cascades_.empty())
    for (const PixelSample& sample : samples) cascades_.add(x, y, sample.radiance * sample.weight);
  if (!keeps_half()) return;
  PixelSums& half = first_half_[static_cast<std::size_t>(y) * width_ + x];
  for (const PixelSample& sample : samples.first(in_first_half)) half.add(sample);
}

Image Film::beauty() const {
  Image image(width(), height());
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const PixelSums& p = pixels_[i];
    const double scale = p.samples > 0 ? 1.0 / p.samples : 0.0;
    const auto at = static_cast<int>(i);
    const Spectrum doubtful = cascades_.empty() ? Spectrum(0) : cascades_.doubtful(at % width_, at / width_);
    for (int c = 0; c < 3; ++c) {
      const double sum = std::max(p.sum[c] - doubtful[c], std::min(p.sum[c], 0.0));  // rounding darkens nothing below 0
      image.pixels()[i][c] = static_cast<float>(sum * scale);
    }
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
  for (int c = 0; c < 3; ++c) channel(kVariance[c], [c](const PixelSums& p) { return p.variance(c); });
  return picture;
}

std::optional<NoisyPicture> Film::noisy_picture() const {
  const bool enough = std::ranges::all_of(pixels_, [](const PixelSums& p) { return p.samples >= kMinimumToDenoise; });
  if (!keeps_half() || !enough) return std::nullopt;
  NoisyPicture picture;
  for (PictureHalf& half : picture.halves) {
    half.color = half.variance = half.albedo = half.normal = Image(width(), height());
    half.depth.resize(pixels_.size());
  }
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    put(first_half_[i], i, picture.halves[0]);
    put(pixels_[i].since(first_half_[i]), i, picture.halves[1]);
  }
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
