#include "sampling/warp.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "testing/random.h"
#include "testing/sphere_grid.h"

namespace etendue {
namespace {

constexpr int kSamples = 200000;
constexpr float kEnds[] = {0, 0x1p-24f, 0.25f, 0.5f, 0.75f, kOneMinusEpsilon};

struct DirectionWarp {
  std::string name;
  std::function<Vec3(Vec2)> sample;
  std::function<float(const Vec3&)> pdf;
  double focus = 1;
};

std::vector<DirectionWarp> direction_warps() {
  std::vector<DirectionWarp> warps = {
      {"cosine-weighted hemisphere", sample_hemisphere_cosine, hemisphere_cosine_pdf},
      {"uniform hemisphere", sample_hemisphere_uniform, hemisphere_uniform_pdf},
      {"uniform sphere", sample_sphere_uniform, [](const Vec3&) { return sphere_uniform_pdf(); }},
  };
  for (const float h : {1e-8f, 1e-4f, 0.1f, 0.9f, 1.5f, 2.0f}) {
    const auto pdf = [h](const Vec3& w) {
      // 1 − cos θ without cancellation.
      const float sin2 = square(w.x) + square(w.y), one_minus_cos = w.z > 0 ? sin2 / (1 + w.z) : 1 - w.z;
      return one_minus_cos <= h ? cone_uniform_pdf(h) : 0.0f;
    };
    const double focus = h < 2 ? std::sqrt(h / (2 - h)) : 1.0;  // tan(θ/2) at the edge
    warps.push_back({"cone of " + std::to_string(h), [h](Vec2 u) { return sample_cone_uniform(u, h); }, pdf, focus});
  }
  return warps;
}

TEST(DirectionWarps, FollowTheirDensities) {
  TestFamily family;
  for (const DirectionWarp& warp : direction_warps()) {
    Random random(1);
    const SphereGrid grid({0, 0, 1}, warp.focus);
    family.add(warp.name, direction_test(
                              grid, kSamples, [&] { return std::optional(warp.sample(random.point())); }, warp.pdf)
                              .p);
    EXPECT_NEAR(integrate_sphere(grid, warp.pdf), 1, 2e-3) << warp.name;
  }
  EXPECT_TRUE(family.holds());
}

TEST(DirectionWarps, AreUnitAndWithinTheirSupport) {
  for (const DirectionWarp& warp : direction_warps())
    for (const float x : kEnds)
      for (const float y : kEnds) {
        const Vec3 w = warp.sample({x, y});
        EXPECT_NEAR(length(w), 1, 1e-6f) << warp.name;
        if (warp.name.find("hemisphere") != std::string::npos) {
          EXPECT_GE(w.z, 0) << warp.name;
        }
      }
}

TEST(ConeWarp, IsPreciseForTheSmallestCones) {
  for (const float h : {1e-12f, 1e-8f, 1e-4f}) {
    const Vec3 w = sample_cone_uniform({kOneMinusEpsilon, 0.3f}, h);
    const double sine = std::sqrt(static_cast<double>(h) * (2 - static_cast<double>(h)));
    EXPECT_NEAR(std::hypot(w.x, w.y) / sine, 1, 1e-6);
  }
}

TEST(DiskWarp, IsUniformByArea) {
  Random random(2);
  std::vector<double> counts(10 * 24);
  for (int i = 0; i < kSamples; ++i) {
    const Vec2 d = sample_disk_concentric(random.point());
    const double r2 = static_cast<double>(d.x) * d.x + static_cast<double>(d.y) * d.y;
    ASSERT_LE(r2, 1 + 1e-6);
    const double turns = std::atan2(d.y, d.x) / (2 * std::numbers::pi) + 0.5;
    ++counts[std::min(static_cast<std::size_t>(r2 * 10), std::size_t{9}) * 24 +
             std::min(static_cast<std::size_t>(turns * 24), std::size_t{23})];
  }
  EXPECT_GT(uniform_test(counts).p, 0.01);
  EXPECT_FLOAT_EQ(disk_pdf() * kPi, 1);
}

TEST(DiskWarp, IsShirleyAndChiusToTheLastBits) {
  Random random(7);
  for (int i = 0; i < 10000; ++i) {
    const Vec2 u = random.point();
    const double x = 2 * u.x - 1, y = 2 * u.y - 1;
    const bool wide = std::abs(x) > std::abs(y);
    const double r = wide ? x : y, angle = std::numbers::pi / 4 * (wide ? y / x : 2 - x / y);
    const Vec2 d = sample_disk_concentric(u);
    EXPECT_NEAR(d.x, r * std::cos(angle), 2e-7);
    EXPECT_NEAR(d.y, r * std::sin(angle), 2e-7);
  }
}

TEST(DiskWarp, KeepsNeighbours) {
  Random random(3);
  for (int i = 0; i < 10000; ++i) {
    const Vec2 u = random.point(), v(std::min(u.x + 1e-3f, 1.0f), u.y);
    EXPECT_LT((sample_disk_concentric(u) - sample_disk_concentric(v)).length(), 4e-3f);
  }
  EXPECT_EQ(sample_disk_concentric({0.5f, 0.5f}), Vec2(0, 0));
}

TEST(TriangleWarp, IsUniformByArea) {
  Random random(4);
  std::vector<double> counts(100);
  for (int i = 0; i < kSamples; ++i) {
    const Vec2 b = sample_triangle_uniform(random.point());
    ASSERT_GE(b.x, 0);
    ASSERT_GE(b.y, 0);
    ASSERT_LE(b.x + b.y, 1);
    // The share of the triangle nearer to the first vertex, and that of it on one side of a line through that vertex.
    const double s = static_cast<double>(b.x) + b.y, share = s > 0 ? b.y / s : 0.0;
    ++counts[std::min(static_cast<std::size_t>(s * s * 10), std::size_t{9}) * 10 +
             std::min(static_cast<std::size_t>(share * 10), std::size_t{9})];
  }
  EXPECT_GT(uniform_test(counts).p, 0.01);
}

TEST(TriangleWarp, StaysInsideAtTheEnds) {
  for (const float x : kEnds)
    for (const float y : kEnds) {
      const Vec2 b = sample_triangle_uniform({x, y});
      EXPECT_GE(b.x, 0);
      EXPECT_GE(b.y, 0);
      EXPECT_LE(b.x + b.y, 1);
    }
}

}  // namespace
}  // namespace etendue
