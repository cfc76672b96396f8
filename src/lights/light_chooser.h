#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lights/light.h"
#include "lights/light_tree.h"
#include "sampling/distribution.h"

namespace etendue {

/// Chooses the light, and the part of it, that a vertex asks: among the finite ones by a LightTree over all their
/// parts, among those at infinity by power; all by power if that is asked for. Between the two by what they promise at
/// the vertex, but each of them at least with probability kLeastShare: neither estimate knows what is in the way.
class LightChooser {
 public:
  static constexpr float kLeastShare = 0.2f;

  LightChooser() = default;
  LightChooser(std::span<const Light> lights, const Bounds3& scene, bool has_tree = true);

  struct Choice {
    std::uint32_t light = 0, part = 0;
    float probability = 1;
  };
  /// From u, uniform in [0, 1). Nothing where no finite light shines. There has to be a light.
  std::optional<Choice> sample(const Receiver& at, double u) const;
  /// The same for many, choices[i] at at[i] by u[i], at most LightTree::kMostAtOnce: they wait for memory together.
  void sample(std::span<const Receiver> at, std::span<const double> u, std::span<std::optional<Choice>> choices) const;
  /// That sample() chooses this part, to the bit.
  float probability(const Receiver& at, std::uint32_t light, std::uint32_t part) const;
  /// There is nothing to choose: u does not matter.
  bool is_certain() const { return only_one_; }

 private:
  struct Part {
    std::uint32_t light, part;
  };

  double share_by_power(const Receiver& at) const;

  bool only_one_ = false;
  LightTree tree_;
  std::vector<Part> in_tree_, by_power_;   ///< as the tree, and the power's distribution, number them
  std::vector<std::uint32_t> first_part_;  ///< of each light, in one or the other
  DiscreteDistribution power_choice_;
  float infinite_irradiance_ = 0;  ///< where there is a tree
};

}  // namespace etendue
