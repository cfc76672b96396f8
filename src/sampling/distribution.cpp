#include "sampling/distribution.h"

#include <algorithm>
#include <cmath>

namespace etendue {

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights) {
  const auto usable = [](double w) { return std::isfinite(w) && w > 0 ? w : 0.0; };
  double total = 0;
  for (const double w : weights) total += usable(w);
  const bool uniform = !(total > 0);
  const double scale = uniform ? 1.0 / static_cast<double>(weights.size()) : 1.0 / total;
  cdf_.reserve(weights.size() + 1);
  cdf_.push_back(0);
  double sum = 0;
  for (const double w : weights) {
    sum += uniform ? 1.0 : usable(w);
    cdf_.push_back(static_cast<float>(std::min(std::round(sum * scale * 0x1p24), 0x1p24) * 0x1p-24));
  }
  cdf_.back() = 1;
  for (std::size_t i = weights.size(); i-- > 1 && !uniform && usable(weights[i]) == 0;)
    cdf_[i] = 1;  // never chosen at the end
  probability_.reserve(weights.size());
  // What rounding makes of the interval is what is sampled, so it is also the probability.
  for (std::size_t i = 0; i < weights.size(); ++i) probability_.push_back(cdf_[i + 1] - cdf_[i]);
}

DiscreteDistribution::Sample DiscreteDistribution::sample(float u) const {
  const auto upper = std::upper_bound(cdf_.begin() + 1, cdf_.end() - 1, u);
  const auto i = static_cast<std::size_t>(upper - cdf_.begin()) - 1;
  return {i, probability_[i]};
}

}  // namespace etendue
