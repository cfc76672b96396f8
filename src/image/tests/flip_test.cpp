#include "image/flip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "base/error.h"
#include "image/io.h"

namespace etendue {
namespace {

Image random_image(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  Image image(width, height);
  for (Spectrum& pixel : image.pixels()) pixel = Spectrum(uniform(random), uniform(random), uniform(random));
  return image;
}

TEST(Flip, EqualPicturesDoNotDiffer) {
  const Image image = random_image(40, 30, 1);
  const FlipError error = flip_error(image, image);
  EXPECT_EQ(error.mean, 0);
  EXPECT_EQ(error.map.size(), 1200u);
  EXPECT_EQ(*std::ranges::max_element(error.map), 0);
}

TEST(Flip, FlatColoursFollowTheFormulas) {
  // Without edges the error is that of the colours alone. Computed apart from the formulas of the paper with L*a*b* of
  // the corners of the sRGB cube: black–white HyAB 100 → 0.9674; blue–green is the largest there is.
  const auto flat = [](const Spectrum& a, const Spectrum& b) {
    return flip_error(Image(8, 8, a), Image(8, 8, b)).mean;
  };
  EXPECT_NEAR(flat({0, 0, 0}, {1, 1, 1}), 0.9674, 2e-4);
  EXPECT_NEAR(flat({0, 0, 1}, {0, 1, 0}), 1, 2e-4);
  // L* of 0.5 is 76.069, of 0.25 it is 57.075: 18.994^0.7 · 0.95 / (0.4 · 41.26).
  EXPECT_NEAR(flat(Spectrum(0.25f), Spectrum(0.5f)), 0.4517, 5e-3);
}

TEST(Flip, AgreesWithADirectEvaluation) {
  // The values come from a separate double-precision program that filters in two dimensions at once.
  Image a(24, 16), b(24, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x) {
      const float red = static_cast<float>((x * 7 + y * 3) % 24) / 24;
      a.at(x, y) = {red, static_cast<float>((x * 5 + y * 11) % 16) / 16, static_cast<float>((x * x + y) % 10) / 10};
      b.at(x, y) = {red, static_cast<float>((x * 5 + y * 9) % 16) / 16, static_cast<float>((x * x + 2 * y) % 10) / 10};
    }
  const FlipError error = flip_error(a, b);
  EXPECT_NEAR(error.mean, 0.3310853, 1e-5);
  EXPECT_NEAR(error.map[3 * 24 + 5], 0.3014172, 1e-4);
  EXPECT_NEAR(error.map[12 * 24 + 20], 0.3960736, 1e-4);
  EXPECT_NEAR(*std::ranges::max_element(error.map), 0.6583717, 1e-4);
}

TEST(Flip, IsSymmetricAndBounded) {
  const Image a = random_image(48, 32, 2), b = random_image(48, 32, 3);
  const FlipError ab = flip_error(a, b), ba = flip_error(b, a);
  EXPECT_NEAR(ab.mean, ba.mean, 1e-6);
  for (std::size_t i = 0; i < ab.map.size(); ++i) {
    ASSERT_NEAR(ab.map[i], ba.map[i], 1e-4);
    ASSERT_GE(ab.map[i], 0);
    ASSERT_LE(ab.map[i], 1);
  }
}

TEST(Flip, MoreNoiseIsMoreError) {
  const Image noise = random_image(64, 64, 4);
  double before = 0;
  for (const float strength : {0.02f, 0.1f, 0.4f}) {
    Image noisy(64, 64, Spectrum(0.3f));
    for (std::size_t i = 0; i < noisy.pixels().size(); ++i)
      noisy.pixels()[i] += (noise.pixels()[i] + Spectrum(-0.5f)) * strength;
    const double mean = flip_error(noisy, Image(64, 64, Spectrum(0.3f))).mean;
    EXPECT_GT(mean, before * 1.5);
    before = mean;
  }
}

TEST(Flip, WhatTheEyeBlursAwayCountsLessThanWhatItSees) {
  // A chequerboard of single pixels is finer than the eye resolves at 67 pixels per degree, but not at 15; broad
  // stripes of the same contrast are seen at both.
  Image fine(96, 96), broad(96, 96);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      fine.at(x, y) = Spectrum((x + y) % 2 == 0 ? 0.45f : 0.55f);
      broad.at(x, y) = Spectrum(x / 24 % 2 == 0 ? 0.45f : 0.55f);
    }
  const Image grey(96, 96, Spectrum(0.5f));
  const double fine_error = flip_error(fine, grey).mean;
  EXPECT_LT(fine_error, 0.05 * flip_error(broad, grey).mean);
  EXPECT_GT(flip_error(fine, grey, 15).mean, 20 * fine_error);
}

TEST(Flip, ErrorStandsWhereTheDifferenceIs) {
  const Image reference(80, 60, Spectrum(0.4f));
  Image image = reference;
  for (int y = 9; y < 12; ++y)
    for (int x = 59; x < 62; ++x) image.at(x, y) = Spectrum(1, 0, 0);
  const FlipError error = flip_error(image, reference);
  const auto largest = std::ranges::max_element(error.map) - error.map.begin();
  EXPECT_NEAR(static_cast<double>(largest % 80), 60, 2);
  EXPECT_NEAR(static_cast<double>(largest / 80), 10, 2);
  EXPECT_GT(error.map[10 * 80 + 60], 0.5f);
  EXPECT_LT(error.map[50 * 80 + 10], 1e-3f);
}

TEST(Flip, ShowsWhatAScreenShows) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Image white(8, 8, Spectrum(1)), black(8, 8);
  EXPECT_EQ(flip_error(Image(8, 8, Spectrum(kInfinity, 2, 1e30f)), white).mean, 0);
  EXPECT_EQ(flip_error(Image(8, 8, Spectrum(std::numeric_limits<float>::quiet_NaN(), -1, -kInfinity)), black).mean, 0);
}

TEST(Flip, DifferentOrNoSizesAreRefused) {
  EXPECT_THROW(flip_error(Image(3, 2), Image(2, 3)), Error);
  EXPECT_THROW(flip_error(Image(), Image()), Error);
  EXPECT_EQ(flip_error(Image(1, 1), Image(1, 1)).mean, 0);
}

}  // namespace
}  // namespace etendue
