#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "volumes/volume.h"

namespace etendue {

/// What all kinds of grid offer. One virtual call a lookup, beside eight reads of memory.
class VolumeGrid {
 public:
  virtual ~VolumeGrid() = default;
  virtual Spectrum lookup(const Point3& world) const = 0;
  virtual ValueRange range(const Bounds3& world) const = 0;
  virtual Bounds3 bounds() const = 0;
};

/// World bounds of a box in the space that `to_world` maps from.
Bounds3 transformed(const Bounds3& box, const Transform& to_world);

/// The grid of that name (empty: the first) in an OpenVDB (.vdb) or NanoVDB (.nvdb) file; what it is, its first bytes
/// say. Throws Error(Failure::input).
std::shared_ptr<const VolumeGrid> read_vdb(const std::filesystem::path& file, const std::string& grid,
                                           const Transform& to_world);

}  // namespace etendue
