#include "picture_statistics.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "math/vec.h"

namespace etendue {
namespace {

double p_of(double difference, double error, double tolerance) {
  const double excess = std::max(std::abs(difference) - tolerance, 0.0);
  return excess == 0 ? 1 : normal_p(excess / error);
}

/// Linear Rec. 709 to CIE XYZ (IEC 61966-2-1).
Spectrum to_xyz(const Spectrum& c) {
  return {0.4124f * c.r + 0.3576f * c.g + 0.1805f * c.b, 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b,
          0.0193f * c.r + 0.1192f * c.g + 0.9505f * c.b};
}

/// Sums over a block: of the means, of the variances of the means, and of what the floor contributes at least.
struct BlockSums {
  double mean[3] = {0, 0, 0}, variance[3] = {0, 0, 0}, floor = 0;

  void add(const SampledPicture& picture, std::size_t pixel, float variance_floor) {
    const Spectrum m = to_xyz(picture.mean.pixels()[pixel]), v = to_xyz(picture.variance.pixels()[pixel]);
    const double n = picture.samples[pixel];
    for (int c = 0; c < 3; ++c) {
      mean[c] += m[c];
      variance[c] += v[c] / n;
    }
    floor += variance_floor / n;
  }
  double variance_of_sum(int channel) const { return std::max(variance[channel], floor); }
};

::testing::AssertionResult same_bits(const std::vector<float>& a, const std::vector<float>& b,
                                     const std::string& name) {
  if (a.size() != b.size()) return ::testing::AssertionFailure() << name << " differs in size";
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]))
      return ::testing::AssertionFailure() << name << " differs, first at value " << i << ": " << a[i] << ", " << b[i];
  return ::testing::AssertionSuccess();
}

std::vector<float> values(const Image& image) {
  std::vector<float> out;
  for (const Spectrum& s : image.pixels()) out.insert(out.end(), {s.r, s.g, s.b});
  return out;
}

}  // namespace

double RegionMean::p_value(double expected, double tolerance) const {
  return p_of(mean - expected, error, tolerance);
}

double RegionMean::p_value(const RegionMean& other, double tolerance) const {
  return p_of(mean - other.mean, std::hypot(error, other.error), tolerance);
}

RegionMean region_mean(const SampledPicture& picture, const CropWindow& window, int channel) {
  double sum = 0, variance = 0;
  for (int y = window.y; y < window.y + window.height; ++y)
    for (int x = window.x; x < window.x + window.width; ++x) {
      sum += picture.mean.at(x, y)[channel];
      variance +=
          picture.variance.at(x, y)[channel] / picture.samples[static_cast<std::size_t>(y) * picture.mean.width() + x];
    }
  const double pixels = static_cast<double>(window.width) * window.height;
  return {sum / pixels, std::sqrt(variance) / pixels};
}

RegionMean region_luminance(const SampledPicture& picture, const PixelPredicate& region) {
  double sum = 0, error = 0, pixels = 0;
  for (int y = 0; y < picture.mean.height(); ++y)
    for (int x = 0; x < picture.mean.width(); ++x) {
      if (!region(x, y)) continue;
      sum += picture.mean.at(x, y).luminance();
      // Channels move together at most: the standard deviation of their sum is no more than the sum of theirs.
      const Spectrum& v = picture.variance.at(x, y);
      const Spectrum deviation(std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b));
      error += square(deviation.luminance()) / picture.samples[static_cast<std::size_t>(y) * picture.mean.width() + x];
      ++pixels;
    }
  return {sum / pixels, std::sqrt(error) / pixels};
}

RunningMean over_pixels(const Image& image, int channel) {
  RunningMean mean;
  for (const Spectrum& s : image.pixels()) mean.add(s[channel]);
  return mean;
}

BlockComparison compare_in_blocks(const SampledPicture& a, const SampledPicture& b, int block, float variance_floor) {
  const int width = a.mean.width(), height = a.mean.height();
  const int columns = (width + block - 1) / block, rows = (height + block - 1) / block;
  BlockComparison out;
  out.alpha = sidak(0.01, static_cast<std::size_t>(columns) * rows);
  out.p_values = Image(columns, rows);
  std::size_t agreeing = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      BlockSums sums_a, sums_b;
      for (int y = row * block; y < std::min((row + 1) * block, height); ++y)
        for (int x = column * block; x < std::min((column + 1) * block, width); ++x) {
          const auto pixel = static_cast<std::size_t>(y) * width + x;
          sums_a.add(a, pixel, variance_floor);
          sums_b.add(b, pixel, variance_floor);
        }
      for (int c = 0; c < 3; ++c) {
        const double z =
            (sums_a.mean[c] - sums_b.mean[c]) / std::sqrt(sums_a.variance_of_sum(c) + sums_b.variance_of_sum(c));
        const double p = normal_p(z);
        out.p_values.at(column, row)[c] = static_cast<float>(p);
        out.rms_z += z * z;
        agreeing += p > out.alpha;
        ++out.tested;
      }
    }
  out.rms_z = std::sqrt(out.rms_z / static_cast<double>(out.tested));
  out.agreeing_share = static_cast<double>(agreeing) / static_cast<double>(out.tested);
  return out;
}

::testing::AssertionResult identical(const Picture& a, const Picture& b) {
  ::testing::AssertionResult result = same_bits(values(a.beauty), values(b.beauty), "the picture");
  if (a.channels.size() != b.channels.size()) return ::testing::AssertionFailure() << "other channels";
  for (std::size_t i = 0; result && i < a.channels.size(); ++i)
    result = same_bits(a.channels[i].values, b.channels[i].values, a.channels[i].name);
  return result;
}

}  // namespace etendue
