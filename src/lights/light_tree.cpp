#include "lights/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/geometry.h"

namespace etendue {
namespace {

constexpr int kBins = 12;
/// From this depth on nodes are halved by count, so that no trail has more than 32 steps.
constexpr int kEvenDepth = 16;
/// Directions and places are rounded: so much farther, as a share of the distance, bounds are believed to reach.
constexpr float kSlack = 1e-3f;
/// A mean cosine is at least this: it is an estimate.
constexpr float kLeastCosine = 5e-3f;
/// What acos may be off by.
constexpr float kAngleError = 5e-4f;
/// A light counts for at least this share of the mean one: its brightness is an estimate.
constexpr double kLeastShare = 1e-3;
/// Numbers stay in the range of floats: what all lights give at a distance of their extent, and how near one is ever
/// believed to be, in units of the extent.
constexpr double kLargest = 0x1p40;
constexpr float kNearest = 1e-7f;

/// What the build knows of a light, or of the sum of several.
struct Summary {
  Bounds3 box;
  double intensity = 0;
  Vec3d resultant{0, 0, 0};  ///< mean of the directions it shines into, × intensity

  void add(const Summary& other) {
    box.extend(other.box);
    intensity += other.intensity;
    resultant += other.resultant;
  }
  /// The orientation bound Ω of Conty Estevez and Kulla (eq. 1) for emission by the cosine. Their bounding cone is
  /// replaced by the one that, uniformly filled, has the same mean direction: sums are all that is needed.
  double orientation() const {
    const double mean = intensity > 0 ? std::min(resultant.length() / intensity, 1.0) : 0.0;
    const double cos_o = 2 * mean - 1, angle = std::acos(cos_o), sin_o = std::sin(angle);
    const double widest = std::min(angle + std::numbers::pi / 2, std::numbers::pi);
    return 2 * std::numbers::pi * (1 - cos_o) +
           std::numbers::pi / 2 * (2 * widest * sin_o - std::cos(angle - 2 * widest) - 2 * angle * sin_o + cos_o);
  }
  /// Expected cost of a node. Its extent stands for the area of its box, which is 0 for lights in a row.
  double cost() const { return intensity * orientation() * length_squared(box.max - box.min); }
};

struct Item {
  Summary summary;
  Point3 center;
  std::uint32_t light;
};

float component(const Vec3& v, int axis) {
  return v[axis];
}

struct Split {
  int axis = -1;  ///< none: no plane parts the lights
  int bin = 0;    ///< the first on the far side
  double cost = std::numeric_limits<double>::infinity();
};

/// Bins of equal width over the centres along an axis.
struct Binning {
  int axis;
  float start, scale;

  Binning(const Bounds3& centers, int axis_in)
      : axis(axis_in),
        start(component(centers.min, axis)),
        scale(static_cast<float>(kBins) / (component(centers.max, axis) - start)) {}
  bool is_usable() const { return std::isfinite(scale); }
  int bin(const Item& item) const {
    return std::clamp(static_cast<int>((component(item.center, axis) - start) * scale), 0, kBins - 1);
  }
};

Bounds3 bounds_of_centers(std::span<const Item> items) {
  Bounds3 out;
  for (const Item& item : items) out.extend(item.center);
  return out;
}

/// The cheapest plane between bins by the surface area orientation heuristic (their eq. 2).
Split best_split(std::span<const Item> items, const Bounds3& centers, const Bounds3& box) {
  const Vec3 extent = box.max - box.min;
  const float longest = std::max({extent.x, extent.y, extent.z});
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    const Binning binning(centers, axis);
    if (!binning.is_usable()) continue;
    std::array<Summary, kBins> bins{};
    for (const Item& item : items) bins[binning.bin(item)].add(item.summary);
    std::array<double, kBins> behind{};  // cost of bins i and those after it
    Summary sum;
    for (int i = kBins; i-- > 1;) {
      sum.add(bins[i]);
      behind[i] = sum.cost();
    }
    sum = {};
    const double thinness = longest / component(extent, axis);
    for (int i = 1; i < kBins; ++i) {
      sum.add(bins[i - 1]);
      const double cost = thinness * (sum.cost() + behind[i]);
      if (cost < best.cost) best = {axis, i, cost};
    }
  }
  return best;
}

/// Parts the items in two; none is empty.
std::size_t partition(std::span<Item> items, const Bounds3& box, bool evenly) {
  const Bounds3 centers = bounds_of_centers(items);
  const auto half = items.begin() + static_cast<std::ptrdiff_t>(items.size() / 2);
  if (evenly) {
    const Vec3 extent = centers.max - centers.min;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::nth_element(items.begin(), half, items.end(), [axis](const Item& a, const Item& b) {
      return component(a.center, axis) < component(b.center, axis);
    });
    return items.size() / 2;
  }
  const Split split = best_split(items, centers, box);
  if (split.axis < 0) return items.size() / 2;
  const Binning binning(centers, split.axis);
  const auto middle =
      std::partition(items.begin(), items.end(), [&](const Item& item) { return binning.bin(item) < split.bin; });
  return static_cast<std::size_t>((middle == items.begin() || middle == items.end() ? half : middle) - items.begin());
}

/// A sphere that holds the box, rounding included.
struct Sphere {
  Point3 center;
  float radius;

  explicit Sphere(const Bounds3& box) : center(box.center()) {
    const float error = kRelativeError * std::max(max_abs_component(box.min), max_abs_component(box.max));
    radius = 0.5f * box.diagonal() * (1 + 1e-5f) + error;
  }
};

}  // namespace

class LightTree::Builder {
 public:
  Builder(LightTree& tree, std::span<const LightBounds> lights) : tree_(tree), lights_(lights) {
    double total = 0;
    Bounds3 box;
    for (const LightBounds& light : lights) {
      total += light.intensity;
      box.extend(light.box);
    }
    const float extent2 = length_squared(box.max - box.min);
    const double sum = total > 0 ? total : 1.0, least = kLeastShare / static_cast<double>(lights.size());
    scale_ = kLargest * (extent2 > 0 ? extent2 : 1.0f) / sum;
    least_radius_ = kNearest * std::sqrt(extent2);
    tree_.unit_ = 1 / scale_;
    items_.reserve(lights.size());
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
      const LightBounds& light = lights[i];
      const double intensity = std::max(static_cast<double>(light.intensity), least * sum);
      const double mean_cosine = 0.5 * (1 + std::cos(static_cast<double>(light.normals.angle)));
      items_.push_back(
          {{light.box, intensity, Vec3d(light.normals.axis) * (mean_cosine * intensity)}, light.box.center(), i});
    }
    tree_.trails_.resize(lights.size());
    tree_.nodes_.reserve(lights.size() / 2 + 1);
    add_node(items_, 0, 0);
  }

 private:
  struct Group {
    std::span<Item> items;
    Summary summary;
    explicit Group(std::span<Item> items_in) : items(items_in) {
      for (const Item& item : items) summary.add(item.summary);
    }
  };

  std::uint32_t add_node(std::span<Item> items, int depth, std::uint64_t trail) {
    const auto index = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.emplace_back();
    const std::vector<Group> groups = divide(items, depth >= kEvenDepth);
    for (std::size_t i = 0; i < 4; ++i) {
      if (i >= groups.size()) {
        tree_.nodes_[index].child[i] = kLeaf;
        continue;
      }
      const std::uint64_t way = trail | std::uint64_t{i} << (kChildBits * depth);
      describe(tree_.nodes_[index], static_cast<int>(i), groups[i]);
      std::uint32_t child = 0;
      if (groups[i].items.size() == 1) {
        const std::uint32_t light = groups[i].items[0].light;
        tree_.trails_[light] = way;
        child = kLeaf | light;
      } else {
        child = add_node(groups[i].items, depth + 1, way);
      }
      tree_.nodes_[index].child[i] = child;
    }
    return index;
  }

  /// Up to four groups: the costliest is parted first.
  static std::vector<Group> divide(std::span<Item> items, bool evenly) {
    std::vector<Group> groups;
    groups.reserve(5);
    groups.emplace_back(items);
    while (groups.size() < 4) {
      const auto worth = [&](const Group& group) {
        if (group.items.size() == 1) return -1.0;
        return evenly ? static_cast<double>(group.items.size()) : group.summary.cost();
      };
      const auto next = std::ranges::max_element(groups, {}, worth);
      if (next->items.size() == 1) break;
      const Group parted = *next;
      const std::size_t middle = partition(parted.items, parted.summary.box, evenly);
      *next = Group(parted.items.first(middle));
      groups.insert(next + 1, Group(parted.items.subspan(middle)));
    }
    return groups;
  }

  /// The narrowest cone about the mean direction that holds all lights'.
  DirectionCone cone_of(const Group& group) const {
    const double length = group.summary.resultant.length();
    if (group.items.size() == 1) return lights_[group.items[0].light].normals;
    if (!(length > 1e-3 * group.summary.intensity)) return DirectionCone::all();
    const Vec3 axis(group.summary.resultant * (1 / length));
    float least_cosine = 1, angle = 0;
    for (const Item& item : group.items) {
      const DirectionCone& cone = lights_[item.light].normals;
      const float cosine = dot(axis, cone.axis);
      if (cone.angle == 0)
        least_cosine = std::min(least_cosine, cosine);
      else
        angle = std::max(angle, std::acos(std::clamp(cosine, -1.0f, 1.0f)) + cone.angle);
    }
    angle = std::max(angle, std::acos(std::max(least_cosine, -1.0f)));
    return {axis, std::min(angle + kAngleError, kPi)};
  }

  void describe(Node& node, int i, const Group& group) const {
    const Sphere sphere(group.summary.box);
    const DirectionCone cone = cone_of(group);
    float cos_emission = 1;
    for (const Item& item : group.items) cos_emission = std::min(cos_emission, lights_[item.light].cos_emission);
    const float widest = std::min(cone.angle + std::acos(cos_emission) + kAngleError, kPi);
    const bool has_axis = cone.angle < kPi;
    node.x[i] = sphere.center.x;
    node.y[i] = sphere.center.y;
    node.z[i] = sphere.center.z;
    node.radius[i] = std::max(sphere.radius, least_radius_);
    node.axis_x[i] = cone.axis.x;
    node.axis_y[i] = cone.axis.y;
    node.axis_z[i] = cone.axis.z;
    node.cos_widest[i] = std::cos(widest);
    node.sin_widest[i] = std::sin(widest);
    node.alike[i] =
        has_axis ? static_cast<float>(std::min(group.summary.resultant.length() / group.summary.intensity, 1.0)) : 0;
    node.intensity[i] = static_cast<float>(group.summary.intensity * scale_);
  }

  LightTree& tree_;
  std::span<const LightBounds> lights_;
  std::vector<Item> items_;
  double scale_ = 1;
  float least_radius_ = 0;
};

LightTree::LightTree(std::span<const LightBounds> lights) {
  if (!lights.empty()) Builder(*this, lights);
}

namespace {

using Float4 [[gnu::vector_size(16)]] = float;
using Int4 [[gnu::vector_size(16)]] = std::int32_t;

Float4 splat(float x) {
  return Float4{x, x, x, x};
}
Float4 root(Float4 x) {
  return Float4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}
Float4 at_least(Float4 x, float low) {
  return x > splat(low) ? x : splat(low);
}
Float4 square(Float4 x) {
  return x * x;
}
/// Mean of max(0, X) for an X of this mean and about this variance.
Float4 positive_part(Float4 mean, Float4 variance) {
  return splat(0.5f) * (mean + root(mean * mean + variance));
}

}  // namespace

/// What each child is likely to give: as if its light filled its bounds evenly, with as many normals about their mean
/// as its length says. Conty Estevez and Kulla's eq. 3 has bounds of the cosines instead, which say little where bounds
/// are near or wide, and the distance of the middle. Nothing where the bounds exclude it.
LightTree::Float4 LightTree::irradiances(const Node& node, const Receiver& at) {
  constexpr float kLeastDistance2 = 1e-24f;
  const Float4 dx = node.x - splat(at.position.x), dy = node.y - splat(at.position.y),
               dz = node.z - splat(at.position.z);
  const Float4 d2 = dx * dx + dy * dy + dz * dz;
  // Of points in a box, from its middle: a third of the squared half diagonal.
  const Float4 spread = node.radius * node.radius * splat(1.0f / 3);
  const Float4 mean_d2 = at_least(d2 + spread, kLeastDistance2), inverse2 = splat(1) / mean_d2,
               inverse = root(inverse2);
  const Float4 along = -(node.axis_x * dx + node.axis_y * dy + node.axis_z * dz);
  const Float4 across = root(at_least(d2 - along * along, 0));
  // Normals in all directions give a quarter of what the same light facing the receiver would.
  const Float4 scatter = splat(0.25f) * (splat(1) - node.alike * node.alike) * mean_d2;
  const Float4 cosine = positive_part(along * node.alike, scatter + spread) * inverse;
  const Float4 reach = node.radius + splat(kSlack) * mean_d2 * inverse;
  const Int4 dark = across * node.cos_widest - along * node.sin_widest > reach;  // so far is the cone away
  const Float4 out = dark ? splat(0) : node.intensity * inverse2 * at_least(cosine, kLeastCosine);
  const Vec3& n = at.normal;
  if (n.x == 0 && n.y == 0 && n.z == 0) return out;
  const Float4 height = splat(n.x) * dx + splat(n.y) * dy + splat(n.z) * dz;
  Float4 lit = positive_part(height, spread) * inverse;
  if (at.gloss > 0) {
    // Walter et al. 2007, eqs. 20 and 33, without shadowing: half vectors are as far apart as lights / their length.
    const Vec3& v = at.to_viewer;
    const float cos_viewer = dot(n, v);
    const Float4 h2 =
        at_least(splat(1) + (d2 * inverse + splat(2) * (splat(v.x) * dx + splat(v.y) * dy + splat(v.z) * dz)) * inverse,
                 kLeastCosine);
    const Float4 cos2 = square(height * inverse + splat(cos_viewer)) / h2;
    const Float4 width2 = splat(at.width2) + spread * inverse2 / h2;
    const Float4 gleam = width2 / square(splat(1) - cos2 + width2 * cos2);
    lit = splat(1 - at.gloss) * lit + splat(at.gloss / (4 * std::max(cos_viewer, kLeastCosine))) * gleam;
  }
  return height < -reach ? splat(0) : out * at_least(lit, kLeastCosine);
}

namespace {

double sum_of(Float4 x) {
  return (static_cast<double>(x[0]) + x[1]) + (static_cast<double>(x[2]) + x[3]);
}

}  // namespace

/// Where a descent stands.
struct LightTree::Descent {
  double u;
  double probability = 1;
  std::uint32_t index = 0;  ///< of the next node, or kLeaf | light; kNoLight: nothing shines
};

inline void LightTree::descend(Descent& at_node, const Receiver& at) const {
  constexpr double kBelowOne = 1 - std::numeric_limits<double>::epsilon();
  const Node& node = nodes_[at_node.index];
  const Float4 given = irradiances(node, at);
  const double total = sum_of(given);
  if (!(total > 0)) {
    at_node.index = kNoLight;
    return;
  }
  const double before[4] = {0, given[0], static_cast<double>(given[0]) + given[1], total - given[3]};
  const double reached = at_node.u * total;
  int i = (reached >= before[1] ? 1 : 0) + (reached >= before[2] ? 1 : 0) + (reached >= before[3] ? 1 : 0);
  while (given[i] == 0) --i;  // rounding has led past the last
  at_node.u = std::clamp((reached - before[i]) / given[i], 0.0, kBelowOne);
  at_node.probability *= given[i] / total;
  at_node.index = node.child[i];
}

std::optional<LightTree::Choice> LightTree::sample(const Receiver& at, double u) const {
  std::optional<Choice> choice;
  sample(std::span(&at, 1), std::span(&u, 1), std::span(&choice, 1));
  return choice;
}

void LightTree::sample(std::span<const Receiver> at, std::span<const double> u,
                       std::span<std::optional<Choice>> choices) const {
  std::ranges::fill(choices, std::nullopt);
  if (nodes_.empty()) return;
  Descent descents[kMostAtOnce];
  int under_way[kMostAtOnce];
  auto count = static_cast<int>(at.size());
  for (int i = 0; i < count; ++i) {
    descents[i] = {u[i]};
    under_way[i] = i;
  }
  while (count > 0) {
    int kept = 0;
    for (int j = 0; j < count; ++j) {
      const int i = under_way[j];
      Descent& descent = descents[i];
      descend(descent, at[i]);
      if ((descent.index & kLeaf) == 0)
        under_way[kept++] = i;
      else if (descent.index != kNoLight)
        choices[i] = Choice{descent.index & ~kLeaf, static_cast<float>(descent.probability)};
    }
    count = kept;
  }
}

float LightTree::probability(const Receiver& at, std::uint32_t light) const {
  double probability = 1;
  std::uint64_t trail = trails_[light];
  for (std::uint32_t index = 0; (index & kLeaf) == 0; trail >>= kChildBits) {
    const Node& node = nodes_[index];
    const Float4 given = irradiances(node, at);
    const auto i = static_cast<int>(trail & 3);
    if (!(given[i] > 0)) return 0;
    probability *= given[i] / sum_of(given);
    index = node.child[i];
  }
  return static_cast<float>(probability);
}

float LightTree::irradiance(const Receiver& at) const {
  return nodes_.empty() ? 0.0f : static_cast<float>(sum_of(irradiances(nodes_[0], at)) * unit_);
}

}  // namespace etendue
