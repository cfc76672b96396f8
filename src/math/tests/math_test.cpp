#include <gtest/gtest.h>

#include "math/frame.h"
#include "math/transform.h"
#include "math/turns.h"

namespace etendue {
namespace {

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Transform, InverseUndoes) {
  const Transform m =
      Transform::translation({1, -2, 3}) * Transform::rotation({1, 2, -1}, 0.7f) * Transform::scaling({2, -0.5f, 3});
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

TEST(Turns, SineAndCosineAreExactToRounding) {
  for (int i = -200000; i <= 200000; ++i) {
    const float turns = static_cast<float>(i) * 1.37e-5f;
    const SinCos found = sin_cos_of_turns(turns);
    const double angle = 2 * std::numbers::pi * static_cast<double>(turns);
    ASSERT_NEAR(found.sin, std::sin(angle), 2e-7) << turns;
    ASSERT_NEAR(found.cos, std::cos(angle), 2e-7) << turns;
  }
  for (const auto& [turns, sin, cos] : {std::array{0.0f, 0.0f, 1.0f}, std::array{0.25f, 1.0f, 0.0f},
                                        std::array{0.5f, 0.0f, -1.0f}, std::array{-0.25f, -1.0f, 0.0f}}) {
    EXPECT_EQ(sin_cos_of_turns(turns).sin, sin);
    EXPECT_EQ(sin_cos_of_turns(turns).cos, cos);
  }
}

TEST(Turns, AnglesAreExactToRounding) {
  for (int i = -20000; i <= 20000; ++i)
    for (const double length : {1e-9, 1.0, 1e9}) {
      const double angle = std::numbers::pi * i / 20000;
      const auto x = static_cast<float>(length * std::cos(angle)), y = static_cast<float>(length * std::sin(angle));
      const double expected = std::atan2(static_cast<double>(y), static_cast<double>(x)) / (2 * std::numbers::pi);
      ASSERT_NEAR(turns_of(y, x), expected, 5e-8) << x << ' ' << y;
      if (std::abs(expected) < 1e-3 && y != 0) {
        ASSERT_NEAR(turns_of(y, x) / expected, 1, 2e-7) << x << ' ' << y;
      }
    }
  EXPECT_EQ(turns_of(0, 0), 0);
  EXPECT_EQ(turns_of(0, 2), 0);
  EXPECT_EQ(turns_of(3, 0), 0.25f);
  EXPECT_EQ(turns_of(0, -1), 0.5f);
  EXPECT_EQ(turns_of(-1, 0), -0.25f);
}

}  // namespace
}  // namespace etendue
