#pragma once

#include <gtest/gtest.h>

#include "math/vec.h"

namespace etendue {

/// That the components of two vectors differ by at most `tolerance` each.
inline void expect_near(const Vec3& a, const Vec3& b, float tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

}  // namespace etendue
