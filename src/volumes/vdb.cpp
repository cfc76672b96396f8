#include <fmt/format.h>
#include <nanovdb/NanoVDB.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "volumes/grid.h"
#include "volumes/nvdb_file.h"
#include "volumes/openvdb_file.h"

namespace etendue {
namespace {

using Coord = nanovdb::Coord;

/// Ranges of more blocks of 8 × 8 × 8 voxels than this are those of the whole grid.
constexpr std::int64_t kMostBlocks = 1 << 14;

Spectrum to_spectrum(float value) {
  return Spectrum(value);
}
Spectrum to_spectrum(const nanovdb::Vec3f& v) {
  return {v[0], v[1], v[2]};
}

struct IndexBox {
  int min[3] = {std::numeric_limits<int>::max(), std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
  int max[3] = {std::numeric_limits<int>::min(), std::numeric_limits<int>::min(), std::numeric_limits<int>::min()};

  void extend(const Coord& first, int size) {
    for (int axis = 0; axis < 3; ++axis) {
      min[axis] = std::min(min[axis], first[axis]);
      max[axis] = std::max(max[axis], first[axis] + (size - 1));
    }
  }
  bool empty() const { return min[0] > max[0]; }
};

/// Looks at every node of a grid before anything follows its offsets: they come from a file. What it finds out on the
/// way are the values' range and where they are.
template <typename T>
class GridInspection {
 public:
  using Tree = typename nanovdb::NanoGrid<T>::TreeType;
  using Root = typename Tree::RootType;
  using Upper = typename Tree::Node2;
  using Lower = typename Tree::Node1;
  using Leaf = typename Tree::Node0;

  explicit GridInspection(std::span<const std::byte> bytes) : bytes_(bytes) {}

  /// Nothing is wrong, or the file lies.
  bool passes() {
    const auto* tree = at<Tree>(bytes_.data(), sizeof(nanovdb::GridData));
    const auto* root = tree ? at<Root>(tree, static_cast<std::int64_t>(tree->data()->mNodeOffset[3])) : nullptr;
    if (!root) return false;
    const auto* data = root->data();
    const std::size_t room = bytes_.size() - position(root) - sizeof(Root);
    if (data->mTableSize > room / sizeof(typename Root::Tile)) return false;
    see(data->mBackground);
    for (std::uint32_t i = 0; i < data->mTableSize; ++i) {
      const auto* tile = data->tile(i);
      if (tile->isChild() ? !inspect(at<Upper>(data, tile->child), tile->origin())
                          : !inspect_tile(tile->value, tile->isActive(), tile->origin(), Upper::DIM))
        return false;
    }
    return true;
  }

  ValueRange range() const { return range_; }
  const IndexBox& box() const { return box_; }

 private:
  std::size_t position(const void* p) const {
    return static_cast<std::size_t>(static_cast<const std::byte*>(p) - bytes_.data());
  }

  /// The node so many bytes from `base`, if all of it lies within the file's.
  template <typename Node>
  const Node* at(const void* base, std::int64_t offset) const {
    const auto size = static_cast<std::int64_t>(bytes_.size()), start = static_cast<std::int64_t>(position(base));
    if (offset < -size || offset > size || offset % 32 != 0) return nullptr;
    const std::int64_t place = start + offset;
    if (place < 0 || place > size - static_cast<std::int64_t>(sizeof(Node))) return nullptr;
    return reinterpret_cast<const Node*>(bytes_.data() + place);
  }

  void see(const typename Root::ValueType& value) {
    const Spectrum s = to_spectrum(value);
    for (int c = 0; c < 3; ++c) range_ = {std::min(range_.min, s[c]), std::max(range_.max, s[c])};
  }

  bool inspect_tile(const typename Root::ValueType& value, bool active, const Coord& origin, int size) {
    see(value);
    if (active) box_.extend(origin, static_cast<int>(size));
    return true;
  }

  template <typename Node>
  bool inspect(const Node* node, const Coord& origin) {
    // Each node belongs to one parent, so there are no more than fit into the file.
    if (!node || (inspected_ += sizeof(Node)) > bytes_.size()) return false;
    if constexpr (Node::LEVEL == 0) {
      return inspect_values(*node, origin);
    } else {
      using Child = typename Node::ChildNodeType;
      const auto* data = node->data();
      for (std::uint32_t i = 0; i < Node::SIZE; ++i) {
        const Coord local = Node::OffsetToLocalCoord(i);
        const Coord place(origin[0] + local[0] * static_cast<int>(Child::DIM),
                          origin[1] + local[1] * static_cast<int>(Child::DIM),
                          origin[2] + local[2] * static_cast<int>(Child::DIM));
        const bool good = data->mChildMask.isOn(i)
                              ? inspect(at<Child>(data, data->mTable[i].child), place)
                              : inspect_tile(data->mTable[i].value, data->mValueMask.isOn(i), place, Child::DIM);
        if (!good) return false;
      }
      return true;
    }
  }

  bool inspect_values(const Leaf& leaf, const Coord& origin) {
    for (std::uint32_t i = 0; i < Leaf::SIZE; ++i) {
      see(leaf.data()->mValues[i]);
      const Coord local = Leaf::OffsetToLocalCoord(i);
      if (leaf.data()->mValueMask.isOn(i))
        box_.extend({origin[0] + local[0], origin[1] + local[1], origin[2] + local[2]}, 1);
    }
    return true;
  }

  std::span<const std::byte> bytes_;
  std::size_t inspected_ = 0;
  ValueRange range_;
  IndexBox box_;
};

/// A sparse grid, interpolated between voxels, whose values are those at the whole numbers of index space.
template <typename T>
class VdbGrid : public VolumeGrid {
 public:
  VdbGrid(NvdbBytes bytes, const Transform& index_to_world, const IndexBox& box, ValueRange range)
      : bytes_(std::move(bytes)), to_world_(index_to_world), to_index_(index_to_world.inverse()), range_(range) {
    // One voxel around those that say something: there values fade to what is outside.
    for (int axis = 0; axis < 3; ++axis) {
      box_.min[axis] = static_cast<float>(box.min[axis]) - 1;
      box_.max[axis] = static_cast<float>(box.max[axis]) + 1;
    }
  }

  Spectrum lookup(const Point3& world) const override {
    const Point3 p = to_index_.point(world);
    int cell[3];
    float weight[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float x = inside(p[axis], axis), below = std::floor(x);
      cell[axis] = static_cast<int>(below);
      weight[axis] = x - below;
    }
    const auto voxels = grid().getAccessor();
    const auto value = [&](int dx, int dy, int dz) {
      return to_spectrum(voxels.getValue({cell[0] + dx, cell[1] + dy, cell[2] + dz}));
    };
    const auto along_x = [&](int y, int z) { return value(0, y, z) * (1 - weight[0]) + value(1, y, z) * weight[0]; };
    const auto in_plane = [&](int z) { return along_x(0, z) * (1 - weight[1]) + along_x(1, z) * weight[1]; };
    return in_plane(0) * (1 - weight[2]) + in_plane(1) * weight[2];
  }

  ValueRange range(const Bounds3& world) const override {
    const Bounds3 local = transformed(world, to_index_);
    int first[3], last[3];
    std::int64_t blocks = 1;
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = static_cast<int>(std::floor(inside(local.min[axis], axis))) & ~7;
      last[axis] = static_cast<int>(std::floor(inside(local.max[axis], axis))) + 1;
      blocks *= std::min<std::int64_t>((static_cast<std::int64_t>(last[axis]) - first[axis]) / 8 + 1, kMostBlocks + 1);
    }
    if (blocks > kMostBlocks) return range_;
    ValueRange range{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
    const auto see = [&range](const Spectrum& s) {
      for (int c = 0; c < 3; ++c) range = {std::min(range.min, s[c]), std::max(range.max, s[c])};
    };
    const auto voxels = grid().getAccessor();
    for (int z = first[2]; z <= last[2]; z += 8)
      for (int y = first[1]; y <= last[1]; y += 8)
        for (int x = first[0]; x <= last[0]; x += 8) {
          const auto* leaf = voxels.probeLeaf({x, y, z});
          if (!leaf) {
            see(to_spectrum(voxels.getValue({x, y, z})));
            continue;
          }
          for (const auto& v : leaf->data()->mValues) see(to_spectrum(v));
        }
    return range;
  }

  Bounds3 bounds() const override { return transformed(box_, to_world_); }

 private:
  const nanovdb::NanoGrid<T>& grid() const {
    return *reinterpret_cast<const nanovdb::NanoGrid<T>*>(bytes_.bytes().data());
  }
  /// The nearest coordinate within the bounds; NaN is their lower end.
  float inside(float x, int axis) const { return x > box_.min[axis] ? std::min(x, box_.max[axis]) : box_.min[axis]; }

  NvdbBytes bytes_;
  Transform to_world_, to_index_;
  Bounds3 box_;  ///< in index space
  ValueRange range_;
};

Vec3 to_vec3(const nanovdb::Vec3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Transform to_transform(const nanovdb::Map& map) {
  const auto image = [&](double x, double y, double z) { return map.applyMap(nanovdb::Vec3d(x, y, z)); };
  const nanovdb::Vec3d origin = image(0, 0, 0);
  return {to_vec3(image(1, 0, 0) - origin), to_vec3(image(0, 1, 0) - origin), to_vec3(image(0, 0, 1) - origin),
          to_vec3(origin)};
}

template <typename T>
std::shared_ptr<const VolumeGrid> make_grid(NvdbBytes bytes, const std::filesystem::path& file,
                                            const Transform& to_world) {
  const auto fail = [&](const char* what) { throw Error(Failure::input, fmt::format("{}: {}.", file.string(), what)); };
  GridInspection<T> inspection(bytes.bytes());
  if (!inspection.passes()) fail("the grid is damaged: its parts lie outside the file");
  if (inspection.box().empty()) fail("the grid holds no values");
  if (!std::isfinite(inspection.range().min) || !std::isfinite(inspection.range().max))
    fail("the grid holds values that are not finite");
  const Transform index_to_world =
      to_world * to_transform(reinterpret_cast<const nanovdb::GridData*>(bytes.bytes().data())->mMap);
  const float volume = index_to_world.determinant();
  if (!(std::abs(volume) > 0) || !std::isfinite(volume) || !is_finite(index_to_world.origin))
    fail("the grid's voxels have no size");
  return std::make_shared<const VdbGrid<T>>(std::move(bytes), index_to_world, inspection.box(), inspection.range());
}

}  // namespace

std::shared_ptr<const VolumeGrid> read_vdb(const std::filesystem::path& file, const std::string& grid,
                                           const Transform& to_world) {
  NvdbBytes bytes = is_openvdb_file(file) ? read_openvdb_file(file, grid) : read_nvdb_file(file, grid);
  const auto& data = *reinterpret_cast<const nanovdb::GridData*>(bytes.bytes().data());
  if (data.mMagic != NANOVDB_MAGIC_NUMBER)
    throw Error(Failure::input, fmt::format("{}: the grid is damaged.", file.string()));
  switch (data.mGridType) {
    case nanovdb::GridType::Float:
      return make_grid<float>(std::move(bytes), file, to_world);
    case nanovdb::GridType::Vec3f:
      return make_grid<nanovdb::Vec3f>(std::move(bytes), file, to_world);
    default:
      throw Error(Failure::input,
                  fmt::format("{}: the grid holds neither floats nor vectors of three floats; no others are read.",
                              file.string()));
  }
}

}  // namespace etendue
