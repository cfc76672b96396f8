// Pictures whose truth is known, with noise of known kinds.

#include "denoise/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "image/compare.h"
#include "synthetic_picture.h"

namespace etendue {
namespace {

Spectrum gradient(int x, int y) {
  return Spectrum(0.2f + 0.008f * static_cast<float>(x), 0.5f, 0.9f - 0.01f * static_cast<float>(y));
}
bool is_right(int x) {
  return x >= Truth::kWidth / 2;
}
Spectrum edge(int x, int) {
  return is_right(x) ? Spectrum(0.9f) : Spectrum(0.1f);
}
Spectrum tiles(int x, int y) {
  return (x / 3 + y / 3) % 2 == 0 ? Spectrum(0.8f, 0.7f, 0.5f) : Spectrum(0.2f, 0.25f, 0.3f);
}

const Truth kGradient{gradient};
const Truth kShadow{edge};
const Truth kPaintedEdge{edge, edge};
const Truth kTexture{[](int x, int y) { return tiles(x, y) * gradient(x, y); }, tiles};

double relative_mse(const Image& image, const Truth& truth) {
  return measure_error(image, image_of(truth.color)).relative_mse;
}

/// By how much denoising lowers the error.
double gain(const Truth& truth, const Noise& noise, int samples) {
  const NoisyPicture picture = noisy_picture(truth, noise, samples);
  return relative_mse(mean_of(picture), truth) / relative_mse(denoise_by_regression(picture).image, truth);
}

double mean_red(const Image& image) {
  double sum = 0;
  for (const Spectrum& pixel : image.pixels()) sum += pixel.r;
  return sum / static_cast<double>(image.pixels().size());
}

TEST(Denoise, LowersTheErrorOfSmoothSurfaces) {
  EXPECT_GT(gain(kGradient, exponential_noise, 4), 40);
  EXPECT_GT(gain(kGradient, exponential_noise, 16), 40);
  EXPECT_GT(gain(kGradient, exponential_noise, 64), 15);
  EXPECT_GT(gain(kGradient, exponential_noise, 1024), 4);
}

TEST(Denoise, LowersTheErrorAtEdges) {
  EXPECT_GT(gain(kShadow, exponential_noise, 8), 50);
  EXPECT_GT(gain(kShadow, exponential_noise, 64), 80);
  EXPECT_GT(gain(kPaintedEdge, exponential_noise, 8), 90);
  EXPECT_GT(gain(kPaintedEdge, exponential_noise, 64), 80);
}

TEST(Denoise, LowersTheErrorOfTexturesThatTheAlbedoShows) {
  EXPECT_GT(gain(kTexture, exponential_noise, 8), 25);
  EXPECT_GT(gain(kTexture, exponential_noise, 64), 6);
  EXPECT_GT(gain(kTexture, exponential_noise, 1024), 2);
}

TEST(Denoise, LowersTheErrorOfRareBrightSamples) {
  EXPECT_GT(gain(kGradient, rare_bright_noise, 8), 30);
  EXPECT_GT(gain(kGradient, rare_bright_noise, 64), 120);
  EXPECT_GT(gain(kTexture, rare_bright_noise, 1024), 15);
}

TEST(Denoise, GoesToTheTruth) {
  double before = std::numeric_limits<double>::infinity();
  for (const int samples : {8, 64, 512, 4096}) {
    const NoisyPicture picture = noisy_picture(kTexture, exponential_noise, samples);
    const double error = relative_mse(denoise_by_regression(picture).image, kTexture);
    EXPECT_LT(error, before) << samples;
    EXPECT_LT(error, relative_mse(mean_of(picture), kTexture)) << samples;
    before = error;
  }
  EXPECT_LT(before, 2e-4);
}

/// The means of the columns beside an edge, relative to the truth: ringing would show, noise does not.
void expect_clean_edge(const Truth& truth, double tolerance) {
  const Image image = denoise_by_regression(noisy_picture(truth, exponential_noise, 256)).image;
  for (int x = Truth::kWidth / 2 - 8; x < Truth::kWidth / 2 + 8; ++x) {
    double sum = 0;
    for (int y = 0; y < image.height(); ++y) sum += image.at(x, y).g / truth.color(x, y).g;
    EXPECT_NEAR(sum / image.height(), 1, tolerance) << x;
  }
}

TEST(Denoise, DoesNotRingAtEdges) {
  expect_clean_edge(kPaintedEdge, 0.02);
  expect_clean_edge(kShadow, 0.02);
}

TEST(Denoise, KeepsTheMean) {
  const Truth grey{[](int, int) { return Spectrum(0.5f); }};
  const NoisyPicture picture = noisy_picture(grey, exponential_noise, 32);
  EXPECT_NEAR(mean_red(denoise_by_regression(picture).image), mean_red(mean_of(picture)), 0.005);
}

TEST(Denoise, LeavesPicturesWithoutNoiseAlone) {
  for (const Truth& truth : {kGradient, kShadow, kTexture}) {
    const Image image = denoise_by_regression(noisy_picture(truth, no_noise, 8)).image;
    EXPECT_LT(measure_error(image, image_of(truth.color)).max_error, 1e-6);
  }
}

TEST(Denoise, KeepsSmallBrightThingsThatBothHalvesSee) {
  Truth lamp{[](int x, int y) { return x == 40 && y == 30 ? Spectrum(50) : Spectrum(0.2f); }};
  const Image image = denoise_by_regression(noisy_picture(lamp, exponential_noise, 256)).image;
  EXPECT_NEAR(image.at(40, 30).r, 50, 10);
  EXPECT_NEAR(image.at(42, 30).r, 0.2, 0.05);
}

TEST(Denoise, GivesNeitherNegativeNorInvalidValues) {
  NoisyPicture picture = noisy_picture(kTexture, rare_bright_noise, 8);
  picture.halves[0].color.at(10, 10) = Spectrum(1e30f);
  picture.halves[0].variance.at(10, 10) = Spectrum(std::numeric_limits<float>::max());
  picture.halves[1].color.at(20, 10) = Spectrum(-3);
  const Image image = denoise_by_regression(picture).image;
  for (const Spectrum& pixel : image.pixels())
    EXPECT_TRUE(is_finite(pixel) && std::min({pixel.r, pixel.g, pixel.b}) >= 0);
}

TEST(Denoise, TakesPicturesOfAnySize) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(2, 40), std::pair(70, 3)}) {
    PictureHalf half{Image(width, height, Spectrum(1)),
                     Image(width, height, Spectrum(0.1f)),
                     Image(width, height, Spectrum(0.5f)),
                     Image(width, height),
                     {}};
    half.depth.assign(half.color.pixels().size(), 0);
    const Image image = denoise_by_regression({{half, half}}).image;
    EXPECT_LT(measure_error(image, half.color).max_error, 1e-5) << width << " x " << height;
  }
}

TEST(Denoise, DoesNotDependOnThreads) {
  const NoisyPicture picture = noisy_picture(kTexture, rare_bright_noise, 16);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return denoise_by_regression(picture).image;
  };
  const Image one = with_threads(1), two = with_threads(2), four = with_threads(4);
  EXPECT_TRUE(std::ranges::equal(one.pixels(), two.pixels()));
  EXPECT_TRUE(std::ranges::equal(one.pixels(), four.pixels()));
}

}  // namespace
}  // namespace etendue
