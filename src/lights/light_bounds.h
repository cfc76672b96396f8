#pragma once

#include "math/bounds.h"
#include "math/vec.h"

namespace etendue {

/// All directions within `angle` of `axis`.
struct DirectionCone {
  Vec3 axis{0, 0, 1};  ///< unit
  float angle = 0;     ///< radians

  static DirectionCone all() { return {{0, 0, 1}, kPi}; }
};

/// Where a finite light, or a part of one, is and into which directions it shines: never too narrow. How bright it is:
/// roughly. At distance d in direction θ from the nearest normal it gives at most intensity · cos θ / d².
struct LightBounds {
  Bounds3 box;
  DirectionCone normals;  ///< of its surface; of a light without one, the directions into which it shines
  /// Cosine of the angle with a normal beyond which nothing shines: 0 for surfaces; 1 where the normals say it all.
  float cos_emission = 0;
  float intensity = 0;  ///< the largest of all directions, luminance, W·sr⁻¹
};

/// A point to be lit.
struct Receiver {
  Point3 position;
  Vec3 normal{0, 0, 0};  ///< unit: nothing comes from behind it, what comes from before it by its cosine; zero: light
                         ///< counts from every side
  Vec3 to_viewer{0, 0, 0};  ///< unit, on the normal's side, if some of it is gloss
  float gloss = 0;          ///< share of GGX microfacets in what it scatters
  float width2 = 0;         ///< their α²

  Receiver moved_to(const Point3& other) const {
    Receiver out = *this;
    out.position = other;
    return out;
  }
};

}  // namespace etendue
