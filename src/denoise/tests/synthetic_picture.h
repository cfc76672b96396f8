#pragma once

#include <cmath>
#include <functional>

#include "denoise/denoise.h"
#include "testing/random.h"

namespace etendue {

/// What is to be seen, and what a renderer would say of its surfaces.
struct Truth {
  static constexpr int kWidth = 97, kHeight = 66;

  std::function<Spectrum(int x, int y)> color;
  std::function<Spectrum(int x, int y)> albedo = [](int, int) { return Spectrum(0.5f); };
};

/// A sample's value as a multiple of the truth, of mean 1.
using Noise = std::function<float(Random&)>;

inline float no_noise(Random&) {
  return 1;
}
/// Standard deviation 1.
inline float exponential_noise(Random& random) {
  return -std::log(1 - random.value());
}
/// One sample in 100 holds half of the light: standard deviation 5.
inline float rare_bright_noise(Random& random) {
  const bool bright = random.value() < 0.01f;
  return (bright ? 50.0f : 0.5f / 0.99f) * exponential_noise(random);
}

inline Image image_of(const std::function<Spectrum(int x, int y)>& color) {
  Image image(Truth::kWidth, Truth::kHeight);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) image.at(x, y) = color(x, y);
  return image;
}

inline PictureHalf noisy_half(const Truth& truth, const Noise& noise, int samples, Random& random) {
  PictureHalf half{image_of(truth.color),
                   Image(Truth::kWidth, Truth::kHeight),
                   image_of(truth.albedo),
                   Image(Truth::kWidth, Truth::kHeight, Spectrum(0, 0, 1)),
                   {}};
  half.depth.assign(half.color.pixels().size(), 2);
  for (std::size_t i = 0; i < half.depth.size(); ++i) {
    double sum = 0, squares = 0;
    for (int s = 0; s < samples; ++s) {
      const double value = noise(random);
      sum += value;
      squares += value * value;
    }
    const double mean = sum / samples, variance = (squares - sum * mean) / (samples - 1) / samples;
    half.variance.pixels()[i] = half.color.pixels()[i] * half.color.pixels()[i] * static_cast<float>(variance);
    half.color.pixels()[i] *= static_cast<float>(mean);
  }
  return half;
}

/// `samples` of each pixel in all.
inline NoisyPicture noisy_picture(const Truth& truth, const Noise& noise, int samples) {
  Random random(7);
  NoisyPicture picture;
  for (PictureHalf& half : picture.halves) half = noisy_half(truth, noise, samples / 2, random);
  return picture;
}

inline Image mean_of(const NoisyPicture& picture) {
  Image mean = picture.halves[0].color;
  for (std::size_t i = 0; i < mean.pixels().size(); ++i)
    mean.pixels()[i] = (mean.pixels()[i] + picture.halves[1].color.pixels()[i]) * 0.5f;
  return mean;
}

}  // namespace etendue
