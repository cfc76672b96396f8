#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace etendue {

/// Discrete distribution with probabilities proportional to given weights, in multiples of 2⁻²⁴, the steps of the
/// sampler's numbers: what probability() says is exactly how often sample() chooses. Sums are doubles. Weights that are
/// negative or not finite count as 0, and so do those below 2⁻²⁵ of the sum; if all are 0, the distribution is uniform.
class DiscreteDistribution {
 public:
  DiscreteDistribution() = default;
  explicit DiscreteDistribution(std::span<const double> weights);

  struct Sample {
    std::size_t index;
    float probability;
  };
  Sample sample(float u) const;

  float probability(std::size_t index) const { return probability_[index]; }
  std::size_t size() const { return probability_.size(); }

 private:
  std::vector<float> cdf_;  ///< size() + 1 values from 0 to 1
  std::vector<float> probability_;
};

}  // namespace etendue
