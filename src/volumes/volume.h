#pragma once

#include <memory>

#include "math/bounds.h"
#include "math/spectrum.h"
#include "math/transform.h"
#include "scene/scene.h"

namespace etendue {

class VolumeGrid;

/// Values between these two.
struct ValueRange {
  float min = 0, max = 0;
};

/// Values in space: constant, on a regular grid, or in a sparse NanoVDB grid. A small handle; copies share
/// the data.
class Volume {
 public:
  explicit Volume(const Spectrum& constant) : constant_(constant) {}
  /// Throws Error(Failure::input) if a file cannot be read.
  explicit Volume(const scene::Volume& description);

  /// The value at a point of the world.
  Spectrum lookup(const Point3& world) const;
  /// What all channels' values within a box of the world lie between, but for rounding.
  ValueRange range(const Bounds3& world) const;
  /// The world's box that the grid was made to fill; lookups outside are defined, but mean little. Empty for constants.
  Bounds3 bounds() const;
  bool is_constant() const { return grid_ == nullptr; }

 private:
  Spectrum constant_;
  std::shared_ptr<const VolumeGrid> grid_;
};

}  // namespace etendue
