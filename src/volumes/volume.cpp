#include "volumes/volume.h"

#include <algorithm>
#include <cmath>

#include "volumes/grid.h"

namespace etendue {
namespace {

int wrapped(int i, int n, scene::TextureWrap wrap) {
  switch (wrap) {
    case scene::TextureWrap::clamp:
      return std::clamp(i, 0, n - 1);
    case scene::TextureWrap::repeat:
      return ((i % n) + n) % n;
    case scene::TextureWrap::mirror: {
      const int r = ((i % (2 * n)) + 2 * n) % (2 * n);
      return r < n ? r : 2 * n - 1 - r;
    }
  }
  return 0;
}

/// Where a local coordinate lies between cell centres: exact for any that floats can tell apart within a grid.
float cell_coordinate(float local, int n) {
  const float x = local * static_cast<float>(n) - 0.5f;
  return std::isfinite(x) ? std::clamp(x, -1e6f, 1e6f) : 0.0f;
}

/// Cells that fill the unit cube of the volume's own space.
class RegularGrid : public VolumeGrid {
 public:
  RegularGrid(const scene::GridVolume& grid, const Transform& to_world)
      : grid_(grid), to_world_(to_world), to_local_(to_world.inverse()) {}

  Spectrum lookup(const Point3& world) const override {
    const Point3 p = to_local_.point(world);
    int cell[3], next[3];
    float weight[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int n = grid_.size[axis];
      const float x = cell_coordinate(p[axis], n);
      const float below = std::floor(x);
      cell[axis] = wrapped(static_cast<int>(below), n, grid_.wrap);
      next[axis] = wrapped(static_cast<int>(below) + 1, n, grid_.wrap);
      weight[axis] = x - below;
      if (grid_.filter == scene::TextureFilter::nearest) {
        if (weight[axis] >= 0.5f) cell[axis] = next[axis];
        next[axis] = cell[axis];
      }
    }
    const auto along_x = [&](int y, int z) {
      return value(cell[0], y, z) * (1 - weight[0]) + value(next[0], y, z) * weight[0];
    };
    const auto in_plane = [&](int z) {
      return along_x(cell[1], z) * (1 - weight[1]) + along_x(next[1], z) * weight[1];
    };
    return in_plane(cell[2]) * (1 - weight[2]) + in_plane(next[2]) * weight[2];
  }

  ValueRange range(const Bounds3& world) const override {
    const Bounds3 local = transformed(world, to_local_);
    int first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int n = grid_.size[axis];
      first[axis] = static_cast<int>(std::floor(cell_coordinate(local.min[axis], n)));
      last[axis] = static_cast<int>(std::floor(cell_coordinate(local.max[axis], n))) + 1;
      const bool leaves = first[axis] < 0 || last[axis] >= n;
      if (leaves && grid_.wrap != scene::TextureWrap::clamp) first[axis] = 0, last[axis] = n - 1;
      first[axis] = std::clamp(first[axis], 0, n - 1);
      last[axis] = std::clamp(last[axis], 0, n - 1);
    }
    ValueRange range{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y) {
        const std::size_t begin = index(first[0], y, z), end = index(last[0], y, z) + grid_.channels;
        for (std::size_t i = begin; i < end; ++i) {
          range.min = std::min(range.min, grid_.values[i]);
          range.max = std::max(range.max, grid_.values[i]);
        }
      }
    return range;
  }

  Bounds3 bounds() const override { return transformed({{0, 0, 0}, {1, 1, 1}}, to_world_); }

 private:
  std::size_t index(int x, int y, int z) const {
    return ((static_cast<std::size_t>(z) * grid_.size[1] + y) * grid_.size[0] + x) * grid_.channels;
  }
  Spectrum value(int x, int y, int z) const {
    const float* v = grid_.values.data() + index(x, y, z);
    return grid_.channels == 1 ? Spectrum(v[0]) : Spectrum(v[0], v[1], v[2]);
  }

  scene::GridVolume grid_;
  Transform to_world_, to_local_;
};

}  // namespace

Bounds3 transformed(const Bounds3& box, const Transform& to_world) {
  Bounds3 out;
  for (int corner = 0; corner < 8; ++corner)
    out.extend(to_world.point(
        {(corner & 1 ? box.max : box.min).x, (corner & 2 ? box.max : box.min).y, (corner & 4 ? box.max : box.min).z}));
  return out;
}

Volume::Volume(const scene::Volume& description) {
  if (const auto* grid = std::get_if<scene::GridVolume>(&description.source)) {
    grid_ = std::make_shared<const RegularGrid>(*grid, description.to_world);
    return;
  }
  const auto& vdb = std::get<scene::VdbVolume>(description.source);
  grid_ = read_vdb(vdb.file, vdb.grid, description.to_world);
}

Spectrum Volume::lookup(const Point3& world) const {
  return grid_ ? grid_->lookup(world) : constant_;
}

ValueRange Volume::range(const Bounds3& world) const {
  if (grid_) return grid_->range(world);
  return {std::min(constant_.r, std::min(constant_.g, constant_.b)), constant_.max()};
}

Bounds3 Volume::bounds() const {
  return grid_ ? grid_->bounds() : Bounds3{};
}

}  // namespace etendue
