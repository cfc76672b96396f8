#pragma once

#include <limits>

#include "math/vec.h"

namespace etendue {

/// A half line from `origin` along `direction` (unit unless said otherwise), used between t_min and t_max.
struct Ray {
  Point3 origin;
  Vec3 direction;
  float t_min = 0;
  float t_max = std::numeric_limits<float>::infinity();

  Point3 at(float t) const { return origin + direction * t; }
};

}  // namespace etendue
