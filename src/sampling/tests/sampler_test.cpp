#include "sampling/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "math/vec.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

constexpr SamplerKind kKinds[] = {SamplerKind::sobol, SamplerKind::independent};

struct Points {
  std::vector<float> u, v;
};

Points draw(const PixelSampler& sampler, std::uint64_t dimension, std::uint64_t first, int count) {
  Points points{std::vector<float>(count), std::vector<float>(count)};
  sampler.points(dimension, first, count, points.u.data(), points.v.data());
  return points;
}

/// Every elementary interval of area 1/count (there are log2(count) + 1 shapes of them) holds one point.
bool is_net(const Points& points) {
  const std::size_t count = points.u.size();
  for (std::size_t columns = 1; columns <= count; columns *= 2) {
    const std::size_t rows = count / columns;
    std::vector<bool> taken(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto column = static_cast<std::size_t>(points.u[i] * static_cast<float>(columns));
      const auto row = static_cast<std::size_t>(points.v[i] * static_cast<float>(rows));
      const std::size_t cell = row * columns + column;
      if (cell >= count || taken[cell]) return false;
      taken[cell] = true;
    }
  }
  return true;
}

TEST(SobolSampler, EveryPrefixIsANet) {
  for (const std::uint64_t seed : {0ull, 1ull, 0xdeadbeef12345678ull})
    for (std::uint32_t pixel = 0; pixel < 5; ++pixel)
      for (const std::uint32_t dimension : {0u, 1u, 2u, 17u, 1000u})
        for (int m = 0; m <= 12; ++m) {
          const PixelSampler sampler(SamplerKind::sobol, seed, pixel, 3 * pixel);
          EXPECT_TRUE(is_net(draw(sampler, dimension, 0, 1 << m)))
              << seed << ' ' << pixel << ' ' << dimension << ' ' << m;
        }
}

TEST(SobolSampler, EveryAlignedBlockIsANet) {
  const PixelSampler sampler(SamplerKind::sobol, 5, 100, 200);
  for (int m = 0; m <= 8; ++m)
    for (std::uint32_t block = 1; block < 20; ++block)
      EXPECT_TRUE(is_net(draw(sampler, 3, block << m, 1 << m))) << m << ' ' << block;
}

/// The points of a square of pixels, each of which takes `count` of `per_sample` points a sample.
Points draw_square(std::uint32_t side, std::uint32_t samples, int per_sample, std::uint32_t x0, std::uint32_t y0) {
  Points all;
  const int count = static_cast<int>(samples) * per_sample;
  for (std::uint32_t y = y0; y < y0 + side; ++y)
    for (std::uint32_t x = x0; x < x0 + side; ++x) {
      Points own{std::vector<float>(count), std::vector<float>(count)};
      PixelSampler(SamplerKind::sobol, 7, x, y, samples).points(5, 0, count, own.u.data(), own.v.data(), per_sample);
      all.u.insert(all.u.end(), own.u.begin(), own.u.end());
      all.v.insert(all.v.end(), own.v.begin(), own.v.end());
    }
  return all;
}

TEST(SobolSampler, NeighboursOfFewSamplesAreANetTogether) {
  for (const std::uint32_t samples : {1u, 4u, 16u})
    for (const int per_sample : {1, 4}) {
      EXPECT_TRUE(is_net(draw_square(1, samples, per_sample, 13, 255)));
      for (const std::uint32_t side : {2u, 4u, 8u}) {
        EXPECT_TRUE(is_net(draw_square(side, samples, per_sample, 8 * 31, 8))) << samples << ' ' << side;
        EXPECT_TRUE(is_net(draw_square(side, samples, per_sample, 8 * 32, 0))) << samples << ' ' << side;
      }
    }
  EXPECT_FALSE(is_net(draw_square(2, PixelSampler::kFewSamples * 2, 1, 8, 8)));
}

/// At any count of samples, the mean over 4 × 4 pixels errs less than if they knew nothing of each other.
TEST(SobolSampler, ErrorsOfNeighboursCancelAtAnyCount) {
  const auto error = [](std::uint32_t samples, bool together) {
    RunningMean squares;
    for (std::uint32_t block = 0; block < 400; ++block) {
      double sum = 0;
      for (std::uint32_t pixel = 0; pixel < 16; ++pixel) {
        const PixelSampler sampler(SamplerKind::sobol, 3, block % 20 * 4 + pixel % 4, block / 20 * 4 + pixel / 4,
                                   together ? samples : 0);
        const Points points = draw(sampler, 11, 0, static_cast<int>(samples));
        for (std::uint32_t i = 0; i < samples; ++i) sum += points.u[i] + points.v[i] < 0.8f ? 1 : 0;
      }
      const double off = sum / (16 * samples) - 0.32;
      squares.add(off * off);
    }
    return squares.mean();
  };
  for (const std::uint32_t samples : {1u, 3u, 5u, 12u, 16u, 37u, 100u})
    EXPECT_LT(1.5 * error(samples, true), error(samples, false)) << samples;
}

/// What goes beyond the samples that were told, or is too much for neighbours to share, is no repetition.
TEST(SobolSampler, MorePointsThanWereToldAreOthers) {
  const PixelSampler sampler(SamplerKind::sobol, 3, 4, 5, 16);
  const Points first = draw(sampler, 1, 0, 16), next = draw(sampler, 1, 16, 16), across = draw(sampler, 1, 8, 16);
  EXPECT_TRUE(is_net(next));
  EXPECT_NE(first.u, next.u);
  for (int i = 0; i < 16; ++i) EXPECT_EQ(across.u[i], i < 8 ? first.u[i + 8] : next.u[i - 8]);
  const auto many = [](std::uint32_t x) {
    float u, v;
    PixelSampler(SamplerKind::sobol, 3, x, 5, 256).points(1, 0, 1, &u, &v, 1 << 20);
    return u;
  };
  EXPECT_NE(many(4), many(5));
}

TEST(SobolSampler, IndependentPointsAreNoNet) {
  EXPECT_FALSE(is_net(draw(PixelSampler(SamplerKind::independent, 0, 0, 0), 0, 0, 64)));
}

TEST(Sampler, ValuesAreBelowOne) {
  for (const SamplerKind kind : kKinds) {
    const Points points = draw(PixelSampler(kind, 1, 2, 3), 4, 0, 1 << 20);
    for (const auto& values : {points.u, points.v})
      for (const float x : values) {
        ASSERT_GE(x, 0);
        ASSERT_LE(x, kOneMinusEpsilon);
      }
  }
}

TEST(Sampler, LargeNumbersOfSamplesAndDimensionsAreNotTheSmallOnesAgain) {
  constexpr std::uint64_t kLarge = std::uint64_t{1} << 32;
  for (const SamplerKind kind : kKinds) {
    const PixelSampler sampler(kind, 42, 640, 480);
    const Points points = draw(sampler, 7, 100, 64);
    EXPECT_NE(points.u, draw(sampler, 7, kLarge + 100, 64).u);
    EXPECT_NE(points.u, draw(sampler, kLarge + 7, 100, 64).u);
    EXPECT_NE(draw(sampler, kLarge + 7, 100, 64).u, draw(sampler, 2 * kLarge + 7, 100, 64).u);
    const Points across = draw(sampler, 7, kLarge - 3, 16);
    for (int i = 0; i < 16; ++i)
      EXPECT_EQ(across.u[i], draw(sampler, 7, kLarge - 3 + static_cast<std::uint64_t>(i), 1).u[0]);
  }
}

TEST(Sampler, DoesNotDependOnHowTheSamplesAreSplit) {
  for (const SamplerKind kind : kKinds) {
    const PixelSampler sampler(kind, 42, 640, 480);
    const Points whole = draw(sampler, 7, 5, 100);
    for (std::uint32_t first = 0, count = 1; first < 100; first += count, count = count % 17 + 1) {
      const int n = static_cast<int>(std::min(count, 100 - first));
      const Points piece = draw(sampler, 7, 5 + first, n);
      for (int i = 0; i < n; ++i) {
        EXPECT_EQ(piece.u[i], whole.u[first + i]);
        EXPECT_EQ(piece.v[i], whole.v[first + i]);
      }
    }
  }
}

TEST(Sampler, SeedPixelAndDimensionChangeEverything) {
  for (const SamplerKind kind : kKinds) {
    const Points base = draw(PixelSampler(kind, 1, 10, 20), 0, 0, 16);
    const Points others[] = {
        draw(PixelSampler(kind, 2, 10, 20), 0, 0, 16), draw(PixelSampler(kind, 1ull << 32 | 1, 10, 20), 0, 0, 16),
        draw(PixelSampler(kind, 1, 11, 20), 0, 0, 16), draw(PixelSampler(kind, 1, 10, 21), 0, 0, 16),
        draw(PixelSampler(kind, 1, 20, 10), 0, 0, 16), draw(PixelSampler(kind, 1, 10, 20), 1, 0, 16),
    };
    for (const Points& other : others)
      for (int i = 0; i < 16; ++i) EXPECT_NE(base.u[i], other.u[i]);
  }
}

/// Counts of points over 16 × 16 cells.
class Histogram {
 public:
  void add(float x, float y) { ++counts_[static_cast<std::size_t>(y * 16) * 16 + static_cast<std::size_t>(x * 16)]; }
  double p() const { return uniform_test(counts_).p; }

 private:
  std::vector<double> counts_ = std::vector<double>(256);
};

TEST(Sampler, OneSampleOfManyPixelsIsUniform) {
  TestFamily family;
  for (const SamplerKind kind : kKinds)
    for (const std::uint32_t index : {0u, 1u, 5u, 1000u})
      for (const std::uint32_t dimension : {0u, 3u}) {
        Histogram histogram;
        for (std::uint32_t y = 0; y < 256; ++y)
          for (std::uint32_t x = 0; x < 256; ++x) {
            const Points p = draw(PixelSampler(kind, 9, x, y), dimension, index, 1);
            histogram.add(p.u[0], p.v[0]);
          }
        family.add("sample " + std::to_string(index) + ", dimension " + std::to_string(dimension), histogram.p());
      }
  EXPECT_TRUE(family.holds());
}

TEST(Sampler, ManyIndependentSamplesOfOnePixelAreUniform) {
  TestFamily family;
  for (std::uint32_t dimension = 0; dimension < 20; ++dimension) {
    const Points p = draw(PixelSampler(SamplerKind::independent, 3, 7, 7), dimension, 0, 1 << 16);
    Histogram pairs, successors;
    for (std::size_t i = 0; i < p.u.size(); ++i) pairs.add(p.u[i], p.v[i]);
    for (std::size_t i = 0; i + 1 < p.u.size(); i += 2) successors.add(p.u[i], p.u[i + 1]);
    family.add("u, v in dimension " + std::to_string(dimension), pairs.p());
    family.add("u of samples i, i + 1 in dimension " + std::to_string(dimension), successors.p());
  }
  EXPECT_TRUE(family.holds());
}

TEST(Sampler, DimensionsAreIndependentFromPixelToPixel) {
  TestFamily family;
  for (const SamplerKind kind : kKinds)
    for (std::uint32_t a = 0; a < 4; ++a)
      for (std::uint32_t b = a + 1; b < 4; ++b) {
        Histogram uu, uv;
        for (std::uint32_t y = 0; y < 256; ++y)
          for (std::uint32_t x = 0; x < 256; ++x) {
            const PixelSampler sampler(kind, 77, x, y);
            const Points pa = draw(sampler, a, 2, 1), pb = draw(sampler, b, 2, 1);
            uu.add(pa.u[0], pb.u[0]);
            uv.add(pa.u[0], pb.v[0]);
          }
        family.add("u, u of " + std::to_string(a) + ", " + std::to_string(b), uu.p());
        family.add("u, v of " + std::to_string(a) + ", " + std::to_string(b), uv.p());
      }
  EXPECT_TRUE(family.holds());
}

/// Within a pixel, too: the mean over its samples of f(one decision) · g(another) is that of f times that of g, on
/// average over pixels.
TEST(Sampler, DimensionsAreIndependentWithinAPixel) {
  const std::function<double(float, float)> functions[] = {
      // Each has the mean 0 and its own scale.
      [](float u, float) { return u - 0.5; },
      [](float, float v) { return v < 0.5f ? -1.0 : 1.0; },
      [](float u, float v) { return std::cos(2 * std::numbers::pi * (u + 2 * v)); },
      [](float u, float v) { return (u < 0.25f) == (v < 0.75f) ? 10.0 : -6.0; },
  };
  TestFamily family;
  for (const SamplerKind kind : kKinds)
    for (const int count : {4, 16, 20})
      for (std::size_t f = 0; f < std::size(functions); ++f)
        for (std::size_t g = 0; g < std::size(functions); ++g) {
          RunningMean mean;
          for (std::uint32_t pixel = 0; pixel < 4000; ++pixel) {
            const PixelSampler sampler(kind, 11, pixel, pixel / 7);
            const Points a = draw(sampler, 1, 0, count), b = draw(sampler, 2, 0, count);
            double sum = 0;
            for (int i = 0; i < count; ++i) sum += functions[f](a.u[i], a.v[i]) * functions[g](b.u[i], b.v[i]);
            mean.add(sum / count);
          }
          family.add(std::to_string(count) + " samples, functions " + std::to_string(f) + ", " + std::to_string(g),
                     mean.p_value(0));
        }
  EXPECT_TRUE(family.holds());
}

/// Root mean square over pixels of the error of the mean of `count` samples of a smooth function.
double rms_error(SamplerKind kind, int count) {
  constexpr double kExact = 0.5577462853510337;  // (√π/2 erf 1)²
  double squares = 0;
  constexpr std::uint32_t kPixels = 256;
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    const Points p = draw(PixelSampler(kind, 5, pixel, 0), 0, 0, count);
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += std::exp(-static_cast<double>(square(p.u[i]) + square(p.v[i])));
    squares += std::pow(sum / count - kExact, 2);
  }
  return std::sqrt(squares / kPixels);
}

TEST(Sampler, ErrorsFallAtTheRateOfTheKind) {
  // Exponent of the error over the number of samples: −1/2 for random numbers, near −3/2 for scrambled nets.
  const auto exponent = [](SamplerKind kind) {
    return std::log(rms_error(kind, 1024) / rms_error(kind, 16)) / std::log(64.0);
  };
  EXPECT_NEAR(exponent(SamplerKind::independent), -0.5, 0.05);
  EXPECT_LT(exponent(SamplerKind::sobol), -1.3);
}

TEST(Sampler, AnyCountOfSobolSamplesBeatsRandomOnes) {
  for (const int count : {3, 7, 24, 100, 1000})
    EXPECT_LT(rms_error(SamplerKind::sobol, count), 0.7 * rms_error(SamplerKind::independent, count)) << count;
  EXPECT_LT(rms_error(SamplerKind::sobol, 1000), 0.1 * rms_error(SamplerKind::independent, 1000));
}

}  // namespace
}  // namespace etendue
