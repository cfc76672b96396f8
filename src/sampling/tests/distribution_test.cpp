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

/// Among a million, each is chosen by about 16 of the sampler's 2²⁴ numbers: the probability must say by how many.
TEST(DiscreteDistribution, KnowsExactlyHowOftenItChooses) {
  std::vector<double> weights;
  Random random(8);
  for (int i = 0; i < 1 << 20; ++i) weights.push_back(1 + random.value());
  const DiscreteDistribution distribution(weights);
  std::vector<int> counts(weights.size());
  constexpr int kNumbers = 1 << 18;  // the lowest, where floats are finer than those numbers
  for (int i = 0; i < kNumbers; ++i) ++counts[distribution.sample(static_cast<float>(i) * 0x1p-24f).index];
  const std::size_t last = distribution.sample(kNumbers * 0x1p-24f).index;
  ASSERT_GT(last, 10000u);
  for (std::size_t i = 0; i < last; ++i)
    ASSERT_EQ(static_cast<float>(counts[i]) * 0x1p-24f, distribution.probability(i)) << i;
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
