#include "image/compare.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "image/io.h"

namespace etendue {
namespace {

void require_same_size(const Image& a, const Image& b) {
  if (a.width() != b.width() || a.height() != b.height() || a.empty())
    throw Error(Failure::usage, fmt::format("the pictures cannot be compared: one is {} × {} pixels, the other {} × {}",
                                            a.width(), a.height(), b.width(), b.height()));
}

double display_value(float linear) {
  return linear_to_srgb(std::clamp(linear, 0.0f, 1.0f));
}

/// The continued fraction of the incomplete beta function (Abramowitz and Stegun 26.5.8), by Lentz' method; converges
/// fast for x < (a + 1) / (a + b + 2).
double beta_fraction(double x, double a, double b) {
  constexpr double kTiny = 1e-300;
  const auto away_from_zero = [](double value) { return std::abs(value) < kTiny ? kTiny : value; };
  double c = 1, d = 1 / away_from_zero(1 - (a + b) * x / (a + 1)), value = d;
  for (int m = 1; m <= 1000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    for (const double term : {even, odd}) {
      d = 1 / away_from_zero(1 + term * d);
      c = away_from_zero(1 + term / c);
      value *= c * d;
    }
    if (std::abs(c * d - 1) < 1e-14) break;
  }
  return value;
}

/// Regularised incomplete beta function I_x(a, b).
double incomplete_beta(double x, double a, double b) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  return x < (a + 1) / (a + b + 2) ? front * beta_fraction(x, a, b) / a : 1 - front * beta_fraction(1 - x, b, a) / b;
}

/// What one picture adds to the variance of a difference of means.
struct MeanVariance {
  double value;    ///< variance of the mean
  double degrees;  ///< with which it is known
};

MeanVariance mean_variance(const SampledPicture& picture, std::size_t pixel, int channel, float floor) {
  const double samples = picture.samples[pixel];
  return {std::max(picture.variance.pixels()[pixel][channel], floor) / samples, samples - 1};
}

struct Difference {
  double t, p;
};

Difference test_difference(double difference, const MeanVariance& a, const MeanVariance& b) {
  const double variance = a.value + b.value;
  const double t = variance > 0 ? difference / std::sqrt(variance) : difference == 0 ? 0.0 : HUGE_VAL;
  const double degrees = variance * variance / (a.value * a.value / a.degrees + b.value * b.value / b.degrees);
  return {t, std::isfinite(t) ? student_two_sided_p(t, variance > 0 ? degrees : 1) : 0.0};
}

/// Sums of one channel over the tested pixels.
struct ChannelSums {
  double difference = 0, variance = 0, squared_t = 0;
  std::size_t tested = 0, agreeing = 0;

  float sigmas() const {
    if (difference == 0) return 0;
    return static_cast<float>(difference / std::sqrt(variance));
  }
};

bool can_be_tested(const SampledPicture& picture, std::size_t pixel) {
  return picture.samples[pixel] >= 2 && is_finite(picture.mean.pixels()[pixel]) &&
         is_finite(picture.variance.pixels()[pixel]);
}

}  // namespace

PictureError measure_error(const Image& image, const Image& reference) {
  require_same_size(image, reference);
  PictureError error;
  double display_mse = 0;
  for (std::size_t i = 0; i < image.pixels().size(); ++i) {
    const Spectrum &a = image.pixels()[i], &r = reference.pixels()[i];
    if (!is_finite(a) || !is_finite(r)) {
      ++error.invalid_pixels;
      continue;
    }
    for (int c = 0; c < 3; ++c) {
      const double difference = static_cast<double>(a[c]) - r[c];
      error.mse += difference * difference;
      error.relative_mse += difference * difference / (static_cast<double>(r[c]) * r[c] + 0.01);
      error.max_error = std::max(error.max_error, std::abs(difference));
      error.mean += a[c];
      error.reference_mean += r[c];
      const double display_difference = display_value(a[c]) - display_value(r[c]);
      display_mse += display_difference * display_difference;
    }
  }
  const double count = 3.0 * static_cast<double>(image.pixels().size() - error.invalid_pixels);
  if (count == 0) return error;
  for (double* sum : {&error.mse, &error.relative_mse, &error.mean, &error.reference_mean}) *sum /= count;
  error.psnr_db = -10 * std::log10(display_mse / count);
  return error;
}

SampledPicture sampled_picture(const Picture& picture) {
  const auto values = [&](std::string_view name) -> const std::vector<float>& {
    for (const Channel& channel : picture.channels)
      if (channel.name == name) return channel.values;
    throw Error(Failure::usage,
                fmt::format("the picture has no channel {}; pictures that are to be tested need variance.R, "
                            "variance.G, variance.B and samples.N, as .exr files of this program have them",
                            name));
  };
  SampledPicture sampled{picture.beauty, Image(picture.beauty.width(), picture.beauty.height()), values("samples.N")};
  const std::array<std::string_view, 3> names = {"variance.R", "variance.G", "variance.B"};
  for (int c = 0; c < 3; ++c) {
    const std::vector<float>& channel = values(names[c]);
    for (std::size_t i = 0; i < channel.size(); ++i) sampled.variance.pixels()[i][c] = channel[i];
  }
  return sampled;
}

WelchTest welch_test(const SampledPicture& a, const SampledPicture& b, float variance_floor) {
  require_same_size(a.mean, b.mean);
  WelchTest test;
  test.p_values = Image(a.mean.width(), a.mean.height(), Spectrum(1));
  const std::size_t pixels = a.mean.pixels().size();
  test.alpha = -std::expm1(std::log(0.99) / static_cast<double>(pixels));
  std::array<ChannelSums, 3> sums;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!can_be_tested(a, i) || !can_be_tested(b, i)) continue;
    for (int c = 0; c < 3; ++c) {
      const double difference = static_cast<double>(a.mean.pixels()[i][c]) - b.mean.pixels()[i][c];
      const auto [t, p] =
          test_difference(difference, mean_variance(a, i, c, variance_floor), mean_variance(b, i, c, variance_floor));
      sums[c].difference += difference;
      sums[c].variance += mean_variance(a, i, c, 0).value + mean_variance(b, i, c, 0).value;
      sums[c].squared_t += t * t;
      sums[c].tested += 1;
      sums[c].agreeing += p > test.alpha;
      test.p_values.pixels()[i][c] = static_cast<float>(p);
    }
  }
  test.tested = sums[0].tested + sums[1].tested + sums[2].tested;
  for (int c = 0; c < 3; ++c) test.mean_difference_sigmas[c] = sums[c].sigmas();
  if (test.tested == 0) return test;
  const double tested = static_cast<double>(test.tested);
  test.agreeing_share = static_cast<double>(sums[0].agreeing + sums[1].agreeing + sums[2].agreeing) / tested;
  test.rms_t = std::sqrt((sums[0].squared_t + sums[1].squared_t + sums[2].squared_t) / tested);
  return test;
}

double student_two_sided_p(double t, double degrees) {
  // 1 − A(t|ν) = I_{ν/(ν+t²)}(ν/2, ½), Abramowitz and Stegun 26.5.27.
  return incomplete_beta(degrees / (degrees + t * t), 0.5 * degrees, 0.5);
}

}  // namespace etendue
