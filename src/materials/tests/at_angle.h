#pragma once

#include <cmath>

#include "math/vec.h"

namespace etendue {

/// The unit direction at these angles from +z and, around it, from +x.
inline Vec3 at_angle(float theta_deg, float phi_deg) {
  const float theta = radians(theta_deg), phi = radians(phi_deg);
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

}  // namespace etendue
