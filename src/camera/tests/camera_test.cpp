#include "camera/camera.h"

#include <gtest/gtest.h>

#include <vector>

#include "testing/expect_near.h"
#include "testing/random.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

Camera pinhole() {
  Camera camera;
  camera.to_world = Transform::look_at({1, 2, 3}, {-2, 0.5f, 1}, {0, 1, 0});
  camera.tan_half_x = 0.8f;
  camera.tan_half_y = 0.45f;
  return camera;
}

Camera with_lens(int blades = 0) {
  Camera camera = pinhole();
  camera.lens_radius = 0.1f;
  camera.focal_distance = 4;
  camera.blades = blades;
  camera.blade_rotation = 0.3f;
  return camera;
}

TEST(Camera, LooksAlongMinusZWithYUp) {
  Camera camera;
  camera.tan_half_x = 0.5f;
  camera.tan_half_y = 0.25f;
  const Vec2 lens(0.5f, 0.5f);
  expect_near(generate_ray(camera, {0.5f, 0.5f}, lens).direction, {0, 0, -1}, 1e-6f);
  expect_near(generate_ray(camera, {0, 0}, lens).direction, normalize(Vec3(-0.5f, 0.25f, -1)), 1e-6f);  // upper left
  expect_near(generate_ray(camera, {1, 1}, lens).direction, normalize(Vec3(0.5f, -0.25f, -1)), 1e-6f);
}

TEST(Camera, PinholeRaysStartAtTheCamera) {
  const Camera camera = pinhole();
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Ray ray = generate_ray(camera, random.point(), random.point());
    EXPECT_EQ(ray.origin, camera.to_world.origin);
    EXPECT_NEAR(length(ray.direction), 1, 1e-6);
    EXPECT_EQ(ray.t_min, 0);
    EXPECT_TRUE(std::isinf(ray.t_max));
  }
}

TEST(Camera, ProjectionUndoesThePinhole) {
  const Camera camera = pinhole();
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 film = random.point();
    const float t = random.between(0.1f, 50);
    const Ray ray = generate_ray(camera, film, {0.5f, 0.5f});
    const FilmPoint point = project(camera, ray.at(t));
    EXPECT_NEAR(point.film.x, film.x, 2e-5);
    EXPECT_NEAR(point.film.y, film.y, 2e-5);
    EXPECT_NEAR(point.distance, -t * dot(ray.direction, camera.to_world.z), 1e-5 * (1 + t));
  }
}

TEST(Camera, ProjectionTellsWhatIsBehindAndBeside) {
  const Camera camera;
  EXPECT_LT(project(camera, {0, 0, 1}).distance, 0);
  EXPECT_GT(project(camera, {0, 0, -1}).distance, 0);
  EXPECT_GT(project(camera, {2, 0, -1}).film.x, 1);
  EXPECT_GT(project(camera, {0, -2, -1}).film.y, 1);  // downwards
  EXPECT_LT(project(camera, {-2, 0, -1}).film.x, 0);
}

TEST(Camera, RaysOfALensMeetInTheSharpPlane) {
  for (const int blades : {0, 5}) {
    const Camera camera = with_lens(blades);
    Camera narrow = camera;
    narrow.lens_radius = 0;
    Random random(3);
    for (int i = 0; i < 200; ++i) {
      const Vec2 film = random.point();
      const Ray central = generate_ray(narrow, film, {0.5f, 0.5f});
      const Point3 sharp = central.at(camera.focal_distance / -dot(central.direction, camera.to_world.z));
      for (int j = 0; j < 10; ++j) {
        const Ray ray = generate_ray(camera, film, random.point());
        EXPECT_NEAR(length(ray.direction), 1, 1e-6);
        const float t = dot(sharp - ray.origin, ray.direction);
        expect_near(ray.at(t), sharp, 1e-5f);
        // It starts on the lens: in the plane through the camera, within the radius.
        const Vec3 from_center = ray.origin - camera.to_world.origin;
        EXPECT_NEAR(dot(from_center, camera.to_world.z), 0, 1e-6);
        EXPECT_LE(length(from_center), camera.lens_radius * (1 + 1e-4f));
      }
    }
  }
}

TEST(Camera, RaysOfALensMissEachOtherElsewhere) {
  const Camera camera = with_lens();
  const Ray a = generate_ray(camera, {0.3f, 0.3f}, {0, 0.5f}),
            b = generate_ray(camera, {0.3f, 0.3f}, {kOneMinusEpsilon, 0.5f});
  const auto at_depth = [&](const Ray& ray, float depth) {
    return ray.at(depth / -dot(ray.direction, camera.to_world.z));
  };
  // The circle of confusion grows with |depth / focal distance − 1|.
  EXPECT_NEAR(length(at_depth(a, 2) - at_depth(b, 2)), 0.1f, 1e-3);
  EXPECT_NEAR(length(at_depth(a, 8) - at_depth(b, 8)), 0.2f, 1e-3);
}

TEST(Camera, ClipsAtDistancesAlongTheAxis) {
  for (Camera camera : {pinhole(), with_lens()}) {
    camera.near_clip = 0.5f;
    camera.far_clip = 20;
    Random random(4);
    for (int i = 0; i < 100; ++i) {
      const Ray ray = generate_ray(camera, random.point(), random.point());
      const auto depth = [&](float t) { return -dot(ray.at(t) - camera.to_world.origin, camera.to_world.z); };
      EXPECT_NEAR(depth(ray.t_min), 0.5f, 1e-5);
      EXPECT_NEAR(depth(ray.t_max), 20, 1e-4);
    }
  }
}

TEST(Aperture, DiskIsUniformByArea) {
  Camera camera;
  camera.lens_radius = 0.7f;
  Random random(5);
  std::vector<double> counts(8 * 16);
  for (int i = 0; i < 100000; ++i) {
    const Vec2 p = sample_aperture(camera, random.point()) / camera.lens_radius;
    const double r2 = p.length2(), turns = std::atan2(p.y, p.x) / (2 * std::numbers::pi) + 0.5;
    ASSERT_LE(r2, 1 + 1e-5);
    ++counts[std::min(static_cast<std::size_t>(r2 * 8), std::size_t{7}) * 16 +
             std::min(static_cast<std::size_t>(turns * 16), std::size_t{15})];
  }
  EXPECT_GT(uniform_test(counts).p, 0.01);
}

/// Distance of a point from the middle of a polygon with one corner at angle 0, as a share of that of the edge there;
/// and which of the polygon's triangles it is in, and where across it.
struct PolygonPoint {
  double out;
  int blade;
  double across;
};
PolygonPoint in_polygon(const Vec2& p, const Camera& camera) {
  const double sector = 2 * std::numbers::pi / camera.blades;
  double angle = std::atan2(p.y, p.x) - static_cast<double>(camera.blade_rotation);
  angle -= 2 * std::numbers::pi * std::floor(angle / (2 * std::numbers::pi));
  const int blade = std::min(static_cast<int>(angle / sector), camera.blades - 1);
  const double from_middle = angle - (blade + 0.5) * sector;
  const double apothem = static_cast<double>(camera.lens_radius) * std::cos(sector / 2);
  const double height = static_cast<double>(p.length()) * std::cos(from_middle);
  return {height / apothem, blade, 0.5 + 0.5 * std::tan(from_middle) / std::tan(sector / 2)};
}

TEST(Aperture, PolygonIsUniformByArea) {
  TestFamily family;
  for (const int blades : {3, 5, 6, 8}) {
    Camera camera;
    camera.lens_radius = 0.7f;
    camera.blades = blades;
    camera.blade_rotation = 0.4f;
    Random random(6);
    std::vector<double> counts(static_cast<std::size_t>(blades) * 36);
    for (int i = 0; i < 100000; ++i) {
      const PolygonPoint p = in_polygon(sample_aperture(camera, random.point()), camera);
      ASSERT_LE(p.out, 1 + 1e-5) << "outside of the polygon";
      // Similar triangles: the area within `out` grows with its square, and evenly across.
      const auto ring = std::min(static_cast<std::size_t>(p.out * p.out * 6), std::size_t{5});
      const auto column = static_cast<std::size_t>(std::clamp(p.across * 6, 0.0, 5.0));
      ++counts[(static_cast<std::size_t>(p.blade) * 6 + ring) * 6 + column];
    }
    family.add(std::to_string(blades) + " blades", uniform_test(counts).p);
  }
  EXPECT_TRUE(family.holds());
}

TEST(Aperture, FillsItsArea) {
  // Share of points of the circumscribed circle's middle that a uniform distribution over the shape's area gives: area
  // = 1 / density.
  for (const int blades : {0, 3, 6}) {
    Camera camera;
    camera.lens_radius = 2;
    camera.blades = blades;
    const double area = blades == 0 ? std::numbers::pi * 4 : 0.5 * blades * 4 * std::sin(2 * std::numbers::pi / blades);
    constexpr double kInner = 0.8;
    constexpr int kSamples = 200000;
    Random random(7);
    int inside = 0;
    for (int i = 0; i < kSamples; ++i)
      inside += static_cast<double>(sample_aperture(camera, random.point()).length()) < kInner;
    const double density = inside / (std::numbers::pi * kInner * kInner * kSamples);
    EXPECT_NEAR(1 / density / area, 1, 0.02) << blades;
  }
}

TEST(Aperture, RotatesCounterClockwiseSeenFromBehind) {
  // From behind the camera x runs to the right and y up: a positive angle is counter-clockwise. A corner of the
  // triangle stands at that angle.
  Camera camera;
  camera.lens_radius = 1;
  camera.blades = 3;
  for (const float rotation : {0.0f, 0.5f, kPi / 2}) {
    camera.blade_rotation = rotation;
    Random random(8);
    float furthest = 0;
    const Vec2 corner(std::cos(rotation), std::sin(rotation));
    for (int i = 0; i < 20000; ++i) furthest = std::max(furthest, sample_aperture(camera, random.point()).dot(corner));
    EXPECT_GT(furthest, 0.97f) << rotation;
    float opposite = 0;
    for (int i = 0; i < 20000; ++i) opposite = std::max(opposite, -sample_aperture(camera, random.point()).dot(corner));
    EXPECT_NEAR(opposite, 0.5f, 0.01f) << rotation;  // the edge across
  }
}

TEST(Aperture, OneOrTwoBladesAreADisk) {
  Camera disk, two;
  disk.lens_radius = two.lens_radius = 1;
  two.blades = 2;
  Random random(9);
  for (int i = 0; i < 100; ++i) {
    const Vec2 u = random.point();
    EXPECT_EQ(sample_aperture(disk, u), sample_aperture(two, u));
  }
}

TEST(Aperture, StaysInsideAtTheEnds) {
  for (const int blades : {0, 3, 5, 7}) {
    Camera camera;
    camera.lens_radius = 1;
    camera.blades = blades;
    for (const float u : {0.0f, 0x1p-24f, 0.5f, kOneMinusEpsilon})
      for (const float v : {0.0f, 0x1p-24f, 0.5f, kOneMinusEpsilon}) {
        const Vec2 p = sample_aperture(camera, {u, v});
        EXPECT_LE(p.length(), 1 + 1e-6f) << blades << ' ' << u << ' ' << v;
      }
  }
}

}  // namespace
}  // namespace etendue
