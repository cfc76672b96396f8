#include "lights/light_chooser.h"

#include <algorithm>

namespace etendue {

LightChooser::LightChooser(std::span<const Light> lights, const Bounds3& scene, bool has_tree) {
  only_one_ = lights.size() == 1 && part_count(lights[0]) == 1;
  std::vector<LightBounds> bounds;
  std::vector<double> power;
  for (std::uint32_t light = 0; light < lights.size(); ++light) {
    const bool by_power = !has_tree || !light_bounds(lights[light], 0);
    std::vector<Part>& parts = by_power ? by_power_ : in_tree_;
    first_part_.push_back(static_cast<std::uint32_t>(parts.size()));
    for (std::uint32_t part = 0; part < part_count(lights[light]); ++part) {
      parts.push_back({light, part});
      if (by_power)
        power.push_back(light_power(lights[light], scene) * part_probability(lights[light], part));
      else
        bounds.push_back(*light_bounds(lights[light], part));
    }
  }
  tree_ = LightTree(bounds);
  if (by_power_.empty()) return;
  double total = 0;
  for (const double p : power) total += p;
  // Half of the choices ignore power: a weak light may be the only one that shines where a vertex is.
  for (double& p : power) p = 0.5 * p + 0.5 * total / static_cast<double>(power.size());
  power_choice_ = DiscreteDistribution(power);
  // Power is what falls on the disk around the scene; half of it is from before a surface.
  const float disk = kPi * square(0.5f * scene.diagonal());
  infinite_irradiance_ = disk > 0 ? static_cast<float>(0.5 * total / disk) : 1.0f;
}

double LightChooser::share_by_power(const Receiver& at) const {
  if (by_power_.empty()) return 0;
  if (tree_.empty()) return 1;
  const float finite = tree_.irradiance(at);
  if (!(finite > 0)) return 1;
  const float share = infinite_irradiance_ / (infinite_irradiance_ + finite);
  return share >= kLeastShare ? std::min(share, 1 - kLeastShare) : kLeastShare;  // kLeastShare for infinity / infinity
}

std::optional<LightChooser::Choice> LightChooser::sample(const Receiver& at, double u) const {
  std::optional<Choice> choice;
  sample(std::span(&at, 1), std::span(&u, 1), std::span(&choice, 1));
  return choice;
}

void LightChooser::sample(std::span<const Receiver> at, std::span<const double> u,
                          std::span<std::optional<Choice>> choices) const {
  if (only_one_) {
    std::ranges::fill(choices, Choice{});
    return;
  }
  Receiver in_tree[LightTree::kMostAtOnce];
  double rest[LightTree::kMostAtOnce], share_of_tree[LightTree::kMostAtOnce];
  int asking[LightTree::kMostAtOnce];
  std::size_t n = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    choices[i].reset();
    const double share = share_by_power(at[i]);
    if (u[i] < share) {
      const float v = std::min(static_cast<float>(u[i] / share), kOneMinusEpsilon);
      const DiscreteDistribution::Sample chosen = power_choice_.sample(v);
      const Part& part = by_power_[chosen.index];
      choices[i] = Choice{part.light, part.part, static_cast<float>(share * chosen.probability)};
      continue;
    }
    in_tree[n] = at[i];
    rest[n] = (u[i] - share) / (1 - share);
    share_of_tree[n] = 1 - share;
    asking[n++] = static_cast<int>(i);
  }
  std::optional<LightTree::Choice> found[LightTree::kMostAtOnce];
  tree_.sample(std::span(in_tree, n), std::span(rest, n), std::span(found, n));
  for (std::size_t j = 0; j < n; ++j) {
    if (!found[j]) continue;
    const Part& part = in_tree_[found[j]->light];
    choices[asking[j]] = Choice{part.light, part.part, static_cast<float>(share_of_tree[j] * found[j]->probability)};
  }
}

float LightChooser::probability(const Receiver& at, std::uint32_t light, std::uint32_t part) const {
  if (only_one_) return 1;
  const double share = share_by_power(at);
  const std::uint32_t first = first_part_[light];
  const bool by_power = first < by_power_.size() && by_power_[first].light == light;
  if (by_power) return static_cast<float>(share * power_choice_.probability(first + part));
  return static_cast<float>((1 - share) * tree_.probability(at, first + part));
}

}  // namespace etendue
