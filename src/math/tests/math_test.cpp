#include <gtest/gtest.h>

#include "math/frame.h"
#include "math/transform.h"

namespace etendue {
namespace {

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Transform, InverseUndoes) {
  const Transform m = Transform::translation({1, -2, 3}) * Transform::rotation({1, 2, -1}, 0.7f) * Transform::scaling({2, -0.5f, 3});
  const Point3 p(0.3f, -1.2f, 2.5f);
  expect_near(m.inverse().point(m.point(p)), p);
}

TEST(Transform, RotationIsCounterClockwise) {
  expect_near(Transform::rotation({0, 0, 2}, kPi / 2).vector({1, 0, 0}), {0, 1, 0});
}

TEST(Transform, NormalsStayPerpendicular) {
  const Transform m = Transform::rotation({0.3f, 1, 0}, 1.1f) * Transform::scaling({1, 4, 0.5f});
  const Vec3 u(1, 2, 0.5f), v(-1, 0.3f, 2);
  const Vec3 n = m.normal(cross(u, v));
  EXPECT_NEAR(dot(n, m.vector(u)), 0, 1e-4f);
  EXPECT_NEAR(dot(n, m.vector(v)), 0, 1e-4f);
}

TEST(Transform, LookAtLooksAlongMinusZ) {
  const Transform m = Transform::look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
  expect_near(m.vector({0, 0, -1}), {0, 0, -1});
  expect_near(m.vector({0, 1, 0}), {0, 1, 0});
  const Transform down = Transform::look_at({0, 5, 0}, {0, 0, 0}, {0, 1, 0});  // up along the view: still a frame
  EXPECT_NEAR(down.determinant(), 1, 1e-5f);
}

TEST(Frame, IsOrthonormalAndRightHandedEverywhere) {
  for (const Vec3& v : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 2, 3), Vec3(-1, 0.2f, -1e-7f), Vec3(0, 1, -0.0f)}) {
    const Frame f = Frame::from_normal(normalize(v));
    expect_near(cross(f.s, f.t), f.n, 1e-6f);
    EXPECT_NEAR(dot(f.s, f.n), 0, 1e-6f);
    EXPECT_NEAR(length(f.s), 1, 1e-6f);
    expect_near(f.to_world(f.to_local({0.1f, 0.2f, 0.3f})), {0.1f, 0.2f, 0.3f}, 1e-6f);
  }
}

}  // namespace
}  // namespace etendue
