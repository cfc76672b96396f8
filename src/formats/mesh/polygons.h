#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"

namespace etendue {

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

/// Whether a triangle is too thin for floats to place it, or not finite: below 10⁻¹⁰ of its length.
bool has_no_area(const Point3& a, const Point3& b, const Point3& c);

/// v / |v|, or zero where that is not a direction.
Vec3 unit_or_zero(const Vec3& v);

}  // namespace etendue
