#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"

namespace etendue::collada {

using Triangle = std::array<std::uint32_t, 3>;

/// A polygon cut into triangles of its own corners, in its own winding.
struct Triangulation {
  std::vector<Triangle> triangles;
  bool is_simple =
      true;  ///< false: the outline crosses itself or is too long to be cut properly; some area may be wrong
};

/// Cuts a planar polygon of n ≥ 3 corners into n − 2 triangles: a fan if it is convex, else by clipping ears (Meisters
/// 1975), so that a non-convex polygon keeps its area. Corners may be collinear; the triangles there have no area.
Triangulation triangulate(std::span<const Point3> corners);

}  // namespace etendue::collada
