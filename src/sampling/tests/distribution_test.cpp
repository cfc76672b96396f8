#include "sampling/distribution.h"

#include <gtest/gtest.h>

#include <limits>

#include "math/vec.h"
#include "testing/random.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

const std::vector<std::vector<double>> kWeights = {
    {1}, {1, 2, 3, 4}, {0, 0, 1, 0, 5, 0, 0}, {1e-3, 1, 1e3}, {1e-300, 3e-300}, std::vector<double>(1000, 0.1),
};

TEST(DiscreteDistribution, ChoosesWithItsProbabilities) {
  TestFamily family;
  for (std::size_t w = 0; w < kWeights.size(); ++w) {
    const std::vector<double>& weights = kWeights[w];
    double total = 0, sum = 0;
    for (const double weight : weights) total += weight;
    const DiscreteDistribution distribution(weights);
    ASSERT_EQ(distribution.size(), weights.size());
    std::vector<double> expected, counts(weights.size());
    constexpr int kSamples = 100000;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      EXPECT_NEAR(distribution.probability(i), weights[i] / total, 2e-7);
      expected.push_back(kSamples * weights[i] / total);
      sum += distribution.probability(i);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    Random random(w);
    for (int i = 0; i < kSamples; ++i) {
      const auto sample = distribution.sample(random.value());
      EXPECT_EQ(sample.probability, distribution.probability(sample.index));
      ++counts[sample.index];
    }
    family.add("weights " + std::to_string(w), chi_square_test(counts, expected).p);
  }
  EXPECT_TRUE(family.holds());
}

/// Every number that a sampler can give, but for the finest: also those next to the steps.
TEST(DiscreteDistribution, NeverChoosesWeightZero) {
  for (const std::vector<double>& weights : kWeights) {
    const DiscreteDistribution distribution(weights);
    for (int i = 0; i < 1 << 24; i += 61) {
      const auto sample = distribution.sample(static_cast<float>(i) * 0x1p-24f);
      ASSERT_GT(weights[sample.index], 0);
    }
    for (const float u : {0.0f, 0x1p-24f, kOneMinusEpsilon}) ASSERT_GT(weights[distribution.sample(u).index], 0);
  }
  // Sums that do not round to 1: what is left over belongs to the last with weight.
  std::vector<double> thirds(3001, 1.0 / 3);
  thirds.resize(6000, 0.0);
  EXPECT_EQ(DiscreteDistribution(thirds).sample(kOneMinusEpsilon).index, 3000u);
}

TEST(DiscreteDistribution, RemapsToAUniformNumber) {
  const DiscreteDistribution distribution(std::vector<double>{1, 0, 2, 5});
  for (std::size_t chosen : {0u, 2u, 3u}) {
    Random random(7);
    std::vector<double> counts(20);
    for (int i = 0; i < 100000; ++i) {
      const auto sample = distribution.sample(random.value());
      ASSERT_GE(sample.remapped, 0);
      ASSERT_LT(sample.remapped, 1);
      if (sample.index == chosen) ++counts[static_cast<std::size_t>(sample.remapped * 20)];
    }
    EXPECT_GT(uniform_test(counts).p, sidak(0.01, 3)) << chosen;
  }
}

TEST(DiscreteDistribution, IsUniformWithoutWeights) {
  const DiscreteDistribution distribution(std::vector<double>(5, 0.0));
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(distribution.probability(i), 0.2, 1e-6);
  EXPECT_EQ(distribution.sample(0).index, 0u);
  EXPECT_EQ(distribution.sample(kOneMinusEpsilon).index, 4u);
}

TEST(DiscreteDistribution, CountsImpossibleWeightsAsZero) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  const DiscreteDistribution distribution(std::vector<double>{-1, kNan, 1, kInfinity, 1, -kInfinity});
  for (const std::size_t i : {0u, 1u, 3u, 5u}) EXPECT_EQ(distribution.probability(i), 0);
  EXPECT_FLOAT_EQ(distribution.probability(2), 0.5f);
  EXPECT_FLOAT_EQ(distribution.probability(4), 0.5f);
}

}  // namespace
}  // namespace etendue
