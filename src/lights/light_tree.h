#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lights/light_bounds.h"

namespace etendue {

/// Chooses among many lights by what they may give to a point: a hierarchy of their bounds, descended by the
/// irradiance that each child promises (Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive
/// Tree Splitting", section 4, without splitting; the promise is a mean, not their bound). Nodes have four children,
/// which are estimated together. Built in the same way every time, in O(n log n).
class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(std::span<const LightBounds> lights);

  struct Choice {
    std::uint32_t light;  ///< index into what the tree was built of
    float probability;
  };
  /// By u, uniform in [0, 1): as a double, since every level takes some of its bits. Nothing where the chosen bounds
  /// turn out to give nothing, and of an empty tree.
  std::optional<Choice> sample(const Receiver& at, double u) const;
  /// The same for many, choices[i] at at[i] by u[i], at most kMostAtOnce: level by level, they wait for memory
  /// together.
  static constexpr int kMostAtOnce = 16;
  void sample(std::span<const Receiver> at, std::span<const double> u, std::span<std::optional<Choice>> choices) const;
  /// That sample() chooses `light`, to the bit. More than 0 if the light's bounds allow that it shines there.
  float probability(const Receiver& at, std::uint32_t light) const;
  /// Of all lights together, by the topmost bounds alone, in the intensities' unit per m². 0 only if nothing shines
  /// there.
  float irradiance(const Receiver& at) const;

  bool empty() const { return nodes_.empty(); }

 private:
  using Float4 [[gnu::vector_size(16)]] = float;

  /// Four children's bounds: spheres around their boxes, and cones into which they shine.
  struct alignas(64) Node {
    Float4 x, y, z, radius;
    Float4 axis_x, axis_y, axis_z, cos_widest, sin_widest;
    Float4 alike;            ///< length of the mean of their normals, each × intensity, which is along the axis
    Float4 intensity;        ///< in multiples of unit_; 0: there is no such child
    std::uint32_t child[4];  ///< another node, or kLeaf | light
  };
  static constexpr std::uint32_t kLeaf = 1u << 31;
  static constexpr std::uint32_t kNoLight = ~0u;
  static constexpr int kChildBits = 2;

  class Builder;
  struct Descent;

  static Float4 irradiances(const Node& node, const Receiver& at);
  void descend(Descent& at_node, const Receiver& at) const;

  std::vector<Node> nodes_;            ///< the root first
  std::vector<std::uint64_t> trails_;  ///< of each light: which child to take at each level, the root's lowest
  double unit_ = 1;                    ///< W·sr⁻¹
};

}  // namespace etendue
