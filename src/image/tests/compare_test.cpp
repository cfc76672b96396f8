#include "image/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "base/error.h"

namespace etendue {
namespace {

using testing::HasSubstr;

TEST(MeasureError, FollowsItsDefinitions) {
  const Image reference(4, 2, Spectrum(0.5f));
  Image image = reference;
  image.at(1, 1) = Spectrum(0.5f, 1.5f, 0.25f);
  const PictureError error = measure_error(image, reference);
  EXPECT_NEAR(error.mse, (1 + 0.0625) / 24, 1e-9);
  EXPECT_NEAR(error.relative_mse, (1 + 0.0625) / 0.26 / 24, 1e-7);
  EXPECT_DOUBLE_EQ(error.max_error, 1);
  EXPECT_NEAR(error.mean, 0.5 + 0.75 / 24, 1e-7);
  EXPECT_NEAR(error.reference_mean, 0.5, 1e-7);
  EXPECT_EQ(error.invalid_pixels, 0u);
  // sRGB of 0.5, 1 (clamped from 1.5) and 0.25: 0.7353569, 1, 0.5370987.
  EXPECT_NEAR(error.psnr_db, -10 * std::log10((0.2646431 * 0.2646431 + 0.1982582 * 0.1982582) / 24), 1e-4);
}

TEST(MeasureError, EqualPicturesHaveNone) {
  const Image image(5, 5, Spectrum(0.3f, 2, 0));
  const PictureError error = measure_error(image, image);
  EXPECT_EQ(error.mse, 0);
  EXPECT_EQ(error.relative_mse, 0);
  EXPECT_EQ(error.max_error, 0);
  EXPECT_EQ(error.psnr_db, std::numeric_limits<double>::infinity());
}

TEST(MeasureError, InvalidPixelsAreCountedAndLeftOut) {
  Image image(2, 2, Spectrum(1)), reference(2, 2, Spectrum(1));
  image.at(0, 0).g = std::numeric_limits<float>::quiet_NaN();
  reference.at(1, 1).r = std::numeric_limits<float>::infinity();
  image.at(1, 0) = Spectrum(3);
  const PictureError error = measure_error(image, reference);
  EXPECT_EQ(error.invalid_pixels, 2u);
  EXPECT_DOUBLE_EQ(error.mse, 2);
  EXPECT_DOUBLE_EQ(error.mean, 2);
}

TEST(MeasureError, DifferentSizesAreRefusedWithBothNamed) {
  try {
    measure_error(Image(3, 2), Image(2, 3));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.failure(), Failure::usage);
    EXPECT_THAT(error.what(), HasSubstr("one is 3 × 2 pixels, the other 2 × 3"));
  }
}

TEST(StudentP, ClosedForms) {
  for (const double t : {0.0, 0.1, 1.0, 3.0, 40.0, 1e4}) {
    EXPECT_NEAR(student_two_sided_p(t, 1), 1 - 2 / M_PI * std::atan(t), 1e-12);     // Cauchy
    EXPECT_NEAR(student_two_sided_p(-t, 2), 1 - t / std::sqrt(2 + t * t), 1e-12);   // ν = 2
    EXPECT_NEAR(student_two_sided_p(t, 1e7), std::erfc(t / std::sqrt(2.0)), 2e-7);  // nearly normal
  }
}

TEST(StudentP, TailsKeepRelativePrecision) {
  // ν = 3: p = 1 − 2/π (atan u + u/(1+u²)), u = t/√3; for large t it tends to 4√3/π · t⁻³ · (1 + …).
  EXPECT_NEAR(student_two_sided_p(1e4, 3) / (4 * std::sqrt(27.0) / (3 * M_PI) * 1e-12), 1, 1e-6);
}

/// A picture whose pixels are means of `samples` draws of a normal distribution, with the variances estimated from
/// them.
SampledPicture gaussian_render(int width, int height, const Spectrum& mean, float sigma, int samples,
                               std::mt19937& random) {
  SampledPicture picture{Image(width, height), Image(width, height),
                         std::vector<float>(static_cast<std::size_t>(width) * height, static_cast<float>(samples))};
  std::normal_distribution<double> normal(0, sigma);
  for (std::size_t i = 0; i < picture.samples.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      double sum = 0, squares = 0;
      for (int s = 0; s < samples; ++s) {
        const double value = normal(random);
        sum += value;
        squares += value * value;
      }
      picture.mean.pixels()[i][c] = static_cast<float>(mean[c] + sum / samples);
      picture.variance.pixels()[i][c] = static_cast<float>((squares - sum * sum / samples) / (samples - 1));
    }
  return picture;
}

TEST(WelchTest, RefusesEqualPicturesAsOftenAsPromised) {
  // Each channel of a pair is a family with error rate 1 %: of 3 · 300 families 9 are expected to refuse a pixel (σ =
  // 3). Few samples and different noise on both sides, where a normal approximation would refuse far too many.
  std::mt19937 random(1);
  int refusing_families = 0;
  double squared_sigmas = 0;
  for (int pair = 0; pair < 300; ++pair) {
    const SampledPicture a = gaussian_render(12, 10, Spectrum(1, 2, 3), 0.5f, 6, random);
    const SampledPicture b = gaussian_render(12, 10, Spectrum(1, 2, 3), 1.0f, 10, random);
    const WelchTest test = welch_test(a, b);
    EXPECT_EQ(test.tested, 360u);
    EXPECT_NEAR(test.alpha, 1 - std::pow(0.99, 1.0 / 120), 1e-12);
    for (int c = 0; c < 3; ++c) {
      const auto refused = [&](const Spectrum& p) { return p[c] <= test.alpha; };
      refusing_families += std::ranges::any_of(test.p_values.pixels(), refused);
      squared_sigmas += test.mean_difference_sigmas[c] * test.mean_difference_sigmas[c];
    }
  }
  EXPECT_GE(refusing_families, 1);
  EXPECT_LE(refusing_families, 20);
  EXPECT_NEAR(squared_sigmas / 900, 1, 0.19);  // mean of 900 χ²₁ values: σ = √(2/900) = 0.047
}

TEST(WelchTest, PValuesAreUniformForEqualPictures) {
  std::mt19937 random(2);
  const WelchTest test = welch_test(gaussian_render(100, 50, Spectrum(1), 0.3f, 64, random),
                                    gaussian_render(100, 50, Spectrum(1), 0.3f, 64, random));
  std::array<int, 10> histogram{};
  for (const Spectrum& p : test.p_values.pixels())
    for (int c = 0; c < 3; ++c) ++histogram[std::min(9, static_cast<int>(p[c] * 10))];
  double chi_squared = 0;
  for (const int count : histogram) chi_squared += (count - 1500.0) * (count - 1500.0) / 1500.0;
  EXPECT_LT(chi_squared, 27.9);  // 99.9 % point of χ² with 9 degrees of freedom
}

TEST(WelchTest, FindsAShiftOfOnePercentOfTheWhole) {
  std::mt19937 random(3);
  const SampledPicture a = gaussian_render(64, 64, Spectrum(1), 0.5f, 16, random);
  const SampledPicture b = gaussian_render(64, 64, Spectrum(1.01f, 1, 1), 0.5f, 16, random);
  const WelchTest test = welch_test(a, b);
  // 0.01 / (0.5 · √(2/16) / 64) = 3.62 is expected; no pixel alone shows it.
  EXPECT_LT(test.mean_difference_sigmas.r, -2);
  EXPECT_LT(std::abs(test.mean_difference_sigmas.g), 3);
  EXPECT_GT(test.agreeing_share, 0.999);
}

TEST(WelchTest, FindsAShiftOfOnePercentInEachPixelWithEnoughSamples) {
  std::mt19937 random(4);
  SampledPicture a = gaussian_render(16, 16, Spectrum(1), 0.05f, 2000, random);
  const SampledPicture b = gaussian_render(16, 16, Spectrum(1.01f), 0.05f, 2000, random);
  EXPECT_LT(welch_test(a, b).agreeing_share, 0.05);  // 6.3 σ each; the threshold is near 4.1
  a = gaussian_render(16, 16, Spectrum(1.01f), 0.05f, 2000, random);
  EXPECT_GT(welch_test(a, b).agreeing_share, 0.99);
}

TEST(WelchTest, PixelsThatSayNothingAreNotTested) {
  std::mt19937 random(5);
  SampledPicture a = gaussian_render(4, 4, Spectrum(1), 0.5f, 8, random);
  const SampledPicture b = gaussian_render(4, 4, Spectrum(9), 0.5f, 8, random);
  a.samples[3] = 1;
  a.mean.at(1, 0).g = std::numeric_limits<float>::quiet_NaN();
  const WelchTest test = welch_test(a, b);
  EXPECT_EQ(test.tested, 3u * 14);
  EXPECT_EQ(test.p_values.at(3, 0), Spectrum(1));
  EXPECT_EQ(test.p_values.at(1, 0), Spectrum(1));
  EXPECT_EQ(test.agreeing_share, 0);
}

TEST(WelchTest, WithoutNoiseOnlyEqualValuesAgree) {
  const SampledPicture a{Image(2, 1, Spectrum(1)), Image(2, 1), {8, 8}};
  SampledPicture b = a;
  b.mean.at(1, 0) = Spectrum(1.001f);
  EXPECT_DOUBLE_EQ(welch_test(a, b, 0).agreeing_share, 0.5);
  EXPECT_EQ(welch_test(a, b, 0).p_values.at(0, 0), Spectrum(1));
  EXPECT_DOUBLE_EQ(welch_test(a, b).agreeing_share, 1);  // the floor takes care of what a few equal samples cannot know
  EXPECT_EQ(welch_test(a, a, 0).mean_difference_sigmas, Spectrum(0));
}

TEST(SampledPicture, ComesFromTheChannelsOfAPicture) {
  const Picture picture{Image(2, 1, Spectrum(5)),
                        {{"variance.R", {1, 2}}, {"variance.G", {3, 4}}, {"variance.B", {5, 6}}, {"samples.N", {7, 8}}},
                        {}};
  const SampledPicture sampled = sampled_picture(picture);
  EXPECT_EQ(sampled.mean.at(1, 0), Spectrum(5));
  EXPECT_EQ(sampled.variance.at(1, 0), Spectrum(2, 4, 6));
  EXPECT_EQ(sampled.samples, (std::vector<float>{7, 8}));
}

TEST(SampledPicture, MissingChannelIsNamed) {
  try {
    sampled_picture({Image(1, 1), {{"samples.N", {4}}, {"variance.R", {4}}}, {}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.failure(), Failure::usage);
    EXPECT_THAT(error.what(), HasSubstr("no channel variance.G"));
  }
}

}  // namespace
}  // namespace etendue
