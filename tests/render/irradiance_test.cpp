// A diffuse plane under lights whose irradiance has a closed form: radiance = ρ E / π.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "picture_statistics.h"
#include "scene_kit.h"

namespace etendue {
namespace {

constexpr float kAlbedo = 0.6f;
constexpr double kPiD = std::numbers::pi;

/// A plane y = 0 lit from above, of which the camera sees a point, the origin, from below all lights.
struct LitPlane {
  SceneKit kit;
  Point3 eye{-1.5f, 1, 1.2f};

  LitPlane() { kit.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, kit.diffuse(Spectrum(kAlbedo))); }
  Camera camera() const { return pinhole(eye, {0, 0, 0}, 1e-4f); }
};

struct Strategy {
  std::string name;
  IntegratorKind integrator;
  int light_samples;
};

const std::vector<Strategy> kByLights = {{"path, one light", IntegratorKind::path, 0},
                                         {"path, 1 light sample", IntegratorKind::path, 1},
                                         {"path, 4 light samples", IntegratorKind::path, 4},
                                         {"direct, one light", IntegratorKind::direct, 0},
                                         {"direct, 4 light samples", IntegratorKind::direct, 4}};
const Strategy kHemisphere{"hemisphere", IntegratorKind::hemisphere, 16};

/// Adds to `tests` that every strategy finds `irradiance`. Sobol samples' standard errors are at most `resolution` of
/// it, independent ones' 2.5 times that: with the level that a family of 50 tests has, errors of 0.5 and of 1.2 % are
/// seen.
void expect_irradiance(TestFamily& tests, const std::string& name, const LitPlane& plane, double irradiance,
                       const std::vector<Strategy>& strategies, double resolution = 0.0012) {
  const RenderScene scene = plane.kit.compile();
  const double expected = kAlbedo * irradiance / kPiD;
  for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::independent})
    for (const Strategy& strategy : strategies) {
      RenderSettings settings = square_settings(32, 64, 1);
      settings.sampler = sampler;
      settings.integrator = strategy.integrator;
      settings.light_samples = strategy.light_samples;
      const Picture picture = render(scene, plane.camera(), settings);
      const RunningMean mean = over_pixels(picture.beauty, 1);
      const std::string what =
          fmt::format("{}, {}, {}", name, strategy.name, sampler == SamplerKind::sobol ? "Sobol" : "independent");
      EXPECT_LT(mean.standard_error(), (sampler == SamplerKind::sobol ? 1 : 2.5) * resolution * expected) << what;
      tests.add(fmt::format("{}: {} instead of {}", what, mean.mean(), expected),
                mean.p_value(expected, 2e-4 * expected));
    }
}

std::vector<Strategy> all_strategies() {
  std::vector<Strategy> all = kByLights;
  all.push_back(kHemisphere);
  return all;
}

/// E / L at the origin, facing up, under a rectangle parallel to it: x0…x1 by z0…z1 at height h (Howell, view factor
/// B-3).
double parallel_rectangle(double x0, double x1, double z0, double z1, double h) {
  const auto corner = [&](double a, double b) {
    const double x = a / h, z = b / h, sx = std::sqrt(1 + x * x), sz = std::sqrt(1 + z * z);
    return 0.5 * (x / sx * std::atan(z / sx) + z / sz * std::atan(x / sz));
  };
  return corner(x1, z1) - corner(x0, z1) - corner(x1, z0) + corner(x0, z0);
}

/// E / L at the origin, facing up, under a polygon above the horizon (Lambert 1760): ½ Σ angle(vᵢ, vᵢ₊₁) · unit(vᵢ ×
/// vᵢ₊₁) · up.
double polygon(const std::vector<Point3>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const Vec3 n = cross(a, b);
    sum += std::atan2(length(n), dot(a, b)) * n.y / length(n);
  }
  return std::abs(sum) / 2;
}

TEST(Irradiance, OfAParallelRectangle) {
  struct Case {
    std::string name;
    float x0, x1, z0, z1, height;
    bool by_hemisphere;
  };
  const std::vector<Case> cases = {{"touching", -0.5f, 0.5f, -0.5f, 0.5f, 0.05f, true},
                                   {"near", -0.4f, 0.6f, -0.2f, 0.7f, 0.4f, true},
                                   {"beside", 0.3f, 1.3f, 0.5f, 1.2f, 0.7f, true},
                                   {"far", -0.5f, 0.5f, -0.2f, 0.2f, 20, false}};
  TestFamily tests;
  for (const Case& c : cases) {
    LitPlane plane;
    if (c.height < 0.1f) plane.eye = {-0.4f, 0.02f, 0};
    const float radiance = 3 * square(std::max(c.height, 1.0f));
    plane.kit.quad({c.x0, c.height, c.z0}, {c.x1 - c.x0, 0, 0}, {0, 0, c.z1 - c.z0},
                   plane.kit.emitter(Spectrum(radiance)));
    const double irradiance = radiance * parallel_rectangle(c.x0, c.x1, c.z0, c.z1, c.height);
    EXPECT_NEAR(
        irradiance,
        radiance *
            polygon({{c.x0, c.height, c.z0}, {c.x1, c.height, c.z0}, {c.x1, c.height, c.z1}, {c.x0, c.height, c.z1}}),
        2e-5 * irradiance + 1e-6);
    expect_irradiance(tests, c.name, plane, irradiance, kByLights);
    if (c.by_hemisphere) expect_irradiance(tests, c.name, plane, irradiance, {kHemisphere}, 0.004);
  }
  EXPECT_TRUE(tests.holds());
}

TEST(Irradiance, OfATiltedRectangleAndOfATriangle) {
  TestFamily tests;
  LitPlane under_rectangle;
  const Point3 corner(0.4f, 0.3f, -0.5f);
  const Vec3 edge_x(0, 0, 0.8f), edge_y(0.5f, 0.9f, 0);
  under_rectangle.kit.quad(corner, edge_x, edge_y, under_rectangle.kit.emitter(Spectrum(5)));
  ASSERT_LT(dot(cross(edge_x, edge_y), corner), 0);  // its front faces the origin
  const double rectangle = 5 * polygon({corner, corner + edge_x, corner + edge_x + edge_y, corner + edge_y});
  expect_irradiance(tests, "tilted rectangle", under_rectangle, rectangle, kByLights);
  expect_irradiance(tests, "tilted rectangle", under_rectangle, rectangle, {kHemisphere}, 0.01);

  LitPlane under_triangle;
  const std::vector<Point3> corners = {{0.6f, 0.5f, -0.6f}, {0.7f, 0.4f, 0.6f}, {-0.1f, 1.2f, 0.1f}};
  ASSERT_LT(dot(cross(corners[1] - corners[0], corners[2] - corners[0]), corners[0]), 0);
  under_triangle.kit.mesh(corners, {{0, 1, 2}}, under_triangle.kit.emitter(Spectrum(5)));
  const double triangle = 5 * polygon(corners);
  expect_irradiance(tests, "triangle", under_triangle, triangle, kByLights);
  expect_irradiance(tests, "triangle", under_triangle, triangle, {kHemisphere}, 0.01);

  LitPlane under_far_triangle;
  std::vector<Point3> far_corners = corners;
  for (Point3& p : far_corners) p += Vec3(2, 5, -3);
  under_far_triangle.kit.mesh(far_corners, {{0, 1, 2}}, under_far_triangle.kit.emitter(Spectrum(300)));
  ASSERT_LT(dot(cross(far_corners[1] - far_corners[0], far_corners[2] - far_corners[0]), far_corners[0]), 0);
  expect_irradiance(tests, "far triangle", under_far_triangle, 300 * polygon(far_corners), kByLights);
  EXPECT_TRUE(tests.holds());
}

TEST(Irradiance, OfALuminousSphere) {
  TestFamily tests;
  for (const auto& [center, radius] : {std::pair(Point3(0, 2, 0), 0.5f), std::pair(Point3(0.7f, 0.9f, -0.4f), 0.8f),
                                       std::pair(Point3(3, 40, -5), 0.6f)}) {
    LitPlane plane;
    const double d2 = length_squared(center), r2 = square(radius);
    const double radiance = 2 * std::max(1.0, d2 / 10);
    plane.kit.sphere(center, radius, plane.kit.emitter(Spectrum(static_cast<float>(radiance))));
    const double irradiance = kPiD * radiance * r2 / d2 * center.y / std::sqrt(d2);  // wholly above the horizon
    const std::string name = fmt::format("sphere at height {}", center.y);
    expect_irradiance(tests, name, plane, irradiance, kByLights);
    if (d2 < 10) expect_irradiance(tests, name, plane, irradiance, {kHemisphere}, 0.01);
  }
  EXPECT_TRUE(tests.holds());
}

TEST(Irradiance, OfTheSkyOnLevelAndTiltedGround) {
  TestFamily tests;
  for (const float tilt_deg : {0.0f, 30.0f, 60.0f}) {
    const float tilt = radians(tilt_deg);
    LitPlane plane;
    plane.kit = SceneKit();
    const Vec3 up_the_slope(std::cos(tilt), std::sin(tilt), 0);
    plane.kit.quad(-up_the_slope * 2 + Vec3(0, 0, 2), up_the_slope * 4, {0, 0, -4},
                   plane.kit.diffuse(Spectrum(kAlbedo)));
    plane.kit.light(scene::HemisphereLight{Spectrum(1.3f)});
    const double irradiance = 1.3 * kPiD * (1 + std::cos(static_cast<double>(tilt))) / 2;
    expect_irradiance(tests, fmt::format("sky, slope of {} degrees", tilt_deg), plane, irradiance, all_strategies(),
                      0.004);
  }
  EXPECT_TRUE(tests.holds());
}

TEST(Irradiance, OfPointSpotAndDirectionalLights) {
  TestFamily tests;
  const Point3 position(0.8f, 1.4f, -0.5f);
  const double distance = length(position), cosine = position.y / distance;

  LitPlane point;
  point.kit.light(scene::PointLight{Spectrum(7)}, Transform::translation(position));
  expect_irradiance(tests, "point", point, 7 * cosine / square(length(position)), kByLights);

  const Point3 target(0.3f, 0, 0.1f);
  const Transform aim = Transform::look_at(position, target, {0, 1, 0});
  const double off_axis = dot(normalize(target - position), normalize(-position));
  for (const float exponent : {0.0f, 1.0f, 8.0f}) {
    LitPlane spot;
    spot.kit.light(scene::SpotLight{Spectrum(7), 30, exponent}, aim);
    expect_irradiance(tests, fmt::format("spot with exponent {}", exponent), spot,
                      7 * std::pow(off_axis, exponent) * cosine / (distance * distance), kByLights);
  }
  LitPlane beside_the_spot;
  beside_the_spot.kit.light(scene::SpotLight{Spectrum(7), 0.9f * degrees(static_cast<float>(std::acos(off_axis))), 0},
                            aim);
  const Picture dark = render(beside_the_spot.kit.compile(), beside_the_spot.camera(), square_settings(4, 16));
  for (const Spectrum& s : dark.beauty.pixels()) EXPECT_EQ(s, Spectrum(0));

  LitPlane directional;
  directional.kit.light(scene::DirectionalLight{Spectrum(2)}, Transform::look_at(position, {0, 0, 0}, {0, 1, 0}));
  expect_irradiance(tests, "directional", directional, 2 * cosine, kByLights);
  EXPECT_TRUE(tests.holds());
}

TEST(Irradiance, OfManyLightsIsTheSum) {
  LitPlane plane;
  const double sky = 0.2;
  plane.kit.light(scene::HemisphereLight{Spectrum(static_cast<float>(sky))});
  plane.kit.light(scene::PointLight{Spectrum(4)}, Transform::translation({0.2f, 1, 0.9f}));
  plane.kit.light(scene::SpotLight{Spectrum(3), 40, 2}, Transform::look_at({-0.2f, 1.5f, 0.9f}, {0, 0, 0}, {0, 1, 0}));
  plane.kit.light(scene::DirectionalLight{Spectrum(0.7f)}, Transform::look_at({-1, 2, -1.5f}, {0, 0, 0}, {0, 1, 0}));
  plane.kit.quad({0.5f, 0.8f, -0.6f}, {0.6f, 0, 0}, {0, 0, 0.7f}, plane.kit.emitter(Spectrum(6)));
  plane.kit.sphere({-0.9f, 1.1f, 0}, 0.3f, plane.kit.emitter(Spectrum(15)));
  const auto delta = [](const Point3& p, double intensity) {
    return intensity * p.y / std::pow(static_cast<double>(length(p)), 3);
  };
  const double rectangle = parallel_rectangle(0.5, 1.1, -0.6, 0.1, 0.8);
  const double d2 = 0.9 * 0.9 + 1.1 * 1.1, sphere = kPiD * 0.09 / d2 * 1.1 / std::sqrt(d2);
  const double irradiance = delta({0.2f, 1, 0.9f}, 4) + delta({-0.2f, 1.5f, 0.9f}, 3) +
                            0.7 * 2 / std::sqrt(1 + 4 + 2.25) + 6 * rectangle + 15 * sphere +
                            sky * (kPiD - rectangle - sphere);  // where they stand before the sky
  TestFamily tests;
  expect_irradiance(tests, "six lights", plane, irradiance, kByLights, 0.005);
  EXPECT_TRUE(tests.holds());
}

TEST(Irradiance, EmittersShineToTheirFrontOnly) {
  LitPlane plane;
  const MaterialId emitter = plane.kit.emitter(Spectrum(5));
  plane.kit.quad({-0.5f, 0.6f, 0.5f}, {1, 0, 0}, {0, 0, -1}, emitter);  // turns its back on the ground
  plane.kit.mesh({{-0.5f, 0.8f, 0.5f}, {0.5f, 0.8f, 0.5f}, {0, 0.8f, -0.5f}}, {{0, 1, 2}}, emitter);
  plane.kit.sphere({0, 3, 0}, 0.5f, emitter);
  const RenderScene scene = plane.kit.compile();
  const Camera beneath = pinhole({0, 0.3f, 0}, {0, 0.6f, 0}, 0.3f), within = pinhole({0, 3, 0}, {1, 3, 0}, 1);
  for (const Strategy& strategy : all_strategies())
    for (const Camera& camera : {plane.camera(), beneath, within}) {
      RenderSettings settings = square_settings(8, 64, 1);
      settings.integrator = strategy.integrator;
      settings.light_samples = strategy.light_samples;
      const Picture picture = render(scene, camera, settings);
      for (const Spectrum& s : picture.beauty.pixels()) ASSERT_EQ(s, Spectrum(0)) << strategy.name;
    }
}

}  // namespace
}  // namespace etendue
