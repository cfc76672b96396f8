// Lights whose solid angle, irradiance or flux is known.

#include <gtest/gtest.h>

#include <vector>

#include "light_kit.h"
#include "lights/light.h"
#include "lights/spherical_triangle.h"
#include "testing/quadrature.h"
#include "testing/random.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

/// Mean of `value` over light samples spread evenly over the unit square; directions without light count as 0.
template <typename Value>
double mean_over_samples(const Light& light, const Point3& from, std::uint32_t seed, int side, Value value) {
  constexpr float kGolden = 0.61803399f;  // spreads the choices evenly, too, and independently of the rest
  Random random(seed);
  float choice = random.value();
  double sum = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Vec2 jitter = random.point();
      choice = choice + kGolden < 1 ? choice + kGolden : choice + kGolden - 1;
      const Vec2 u((static_cast<float>(x) + jitter.x) / static_cast<float>(side),
                   (static_cast<float>(y) + jitter.y) / static_cast<float>(side));
      if (const auto s =
              sample_whole(light, from, {std::min(u.x, kOneMinusEpsilon), std::min(u.y, kOneMinusEpsilon)}, choice))
        sum += value(*s);
    }
  return sum / side / side;
}

/// Red irradiance that `light` gives a surface at `from` facing `normal`.
double irradiance(const Light& light, const Point3& from, const Vec3& normal, int side = 256) {
  return mean_over_samples(light, from, 4, side, [&](const LightSample& s) {
    return static_cast<double>(s.radiance.r) * std::max(dot(s.wi, normal), 0.0f) / s.pdf;
  });
}

/// The solid angle from which the light comes: the mean of 1 / pdf.
double sampled_solid_angle(const Light& light, const Point3& from, int side = 256) {
  return mean_over_samples(light, from, 5, side, [](const LightSample& s) { return 1 / static_cast<double>(s.pdf); });
}

/// Irradiance per radiance of a polygon that is wholly above the horizon of `normal` (Lambert 1760).
double polygon_irradiance(const std::vector<Point3>& corners, const Point3& from, const Vec3& normal) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = (Vec3d(corners[i]) - Vec3d(from)).normalized(),
                b = (Vec3d(corners[(i + 1) % corners.size()]) - Vec3d(from)).normalized();
    const Vec3d c = a.cross(b);
    sum += std::atan2(c.length(), a.dot(b)) * c.normalized().dot(Vec3d(normal));
  }
  return 0.5 * std::abs(sum);
}

/// Solid angle of a triangle (Van Oosterom and Strackee 1983), in doubles.
double triangle_solid_angle(const Point3& p0, const Point3& p1, const Point3& p2, const Point3& from) {
  const Vec3d a = Vec3d(p0) - Vec3d(from), b = Vec3d(p1) - Vec3d(from), c = Vec3d(p2) - Vec3d(from);
  const double la = a.length(), lb = b.length(), lc = c.length();
  return 2 * std::atan2(std::abs(a.dot(b.cross(c))), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

/// Places in front of a unit light at y = 0 that shines down; heights from touching to far, beside it and below it.
std::vector<Point3> places_below(float least_height) {
  std::vector<Point3> places;
  for (const float height : {0.0005f, 0.002f, 0.005f, 0.02f, 0.1f, 0.5f, 1.3f, 1.5f, 4.0f, 20.0f})
    for (const Vec2& beside : {Vec2(0, 0), Vec2(0.45f, 0.2f), Vec2(0.6f, 0.1f), Vec2(1.5f, -0.3f), Vec2(2.5f, 2)})
      if (height >= least_height) places.push_back({beside.x, -height, beside.y});
  return places;
}

/// How well a mean over light samples must agree. Samples by area from a place very close to the light have an enormous
/// variance, and are nevertheless right: they are judged by the χ² test alone.
bool by_area_from_close(const Point3& from) {
  return from.y > -0.0011f && std::abs(from.x) < 0.7f;
}

TEST(RectangleLight, GivesItsSolidAngleAndIrradiance) {
  const Rectangle rectangle({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 0, 1});
  const RectangleLight light{rectangle, Spectrum(1)};
  const std::vector<Point3> corners = {{-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}, {-0.5f, 0, 0.5f}};
  for (const Point3& from : places_below(0)) {
    if (by_area_from_close(from)) continue;
    const double solid_angle = triangle_solid_angle(corners[0], corners[1], corners[2], from) +
                               triangle_solid_angle(corners[0], corners[2], corners[3], from);
    EXPECT_NEAR(sampled_solid_angle(light, from) / solid_angle, 1, 3e-3) << from;
    const double exact = polygon_irradiance(corners, from, {0, 1, 0});
    EXPECT_NEAR(irradiance(light, from, {0, 1, 0}) / exact, 1, 3e-3) << from;
  }
}

TEST(RectangleLight, AgreesWithTheTextbooksFormFactors) {
  // A corner of the light above the place: parallel, and perpendicular with the light's edge in the receiver's plane.
  const float a = 0.8f, b = 1.3f, h = 0.7f;
  const RectangleLight light{Rectangle({0, 0, 0}, {a, 0, 0}, {0, 0, b}), Spectrum(1)};
  const double x = a / h, y = b / h;
  const double parallel = (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) +
                           y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y))) /
                          (2 * std::numbers::pi);
  EXPECT_NEAR(irradiance(light, {0, -h, 0}, {0, 1, 0}), std::numbers::pi * parallel, 1e-3);
  // Facing +x: the light's edge x = 0 is straight above, the far edge at distance a.
  const double y2 = b / std::hypot(static_cast<double>(a), h);
  const double perpendicular = (std::atan(y) - 1 / std::sqrt(1 + x * x) * std::atan(y2)) / (2 * std::numbers::pi);
  EXPECT_NEAR(irradiance(light, {0, -h, 0}, {1, 0, 0}), std::numbers::pi * perpendicular, 1e-3);
}

TEST(RectangleLight, LongStripsAreLitAlongTheirWholeLength) {
  const RectangleLight light{Rectangle({-5, 0, -0.05f}, {10, 0, 0}, {0, 0, 0.1f}), Spectrum(1)};
  const RectangleLight across{Rectangle({-0.05f, 0, -5}, {0.1f, 0, 0}, {0, 0, 10}), Spectrum(1)};
  for (const float height : {0.002f, 0.01f, 0.1f, 1.0f})
    for (const float along : {0.0f, 2.0f, 4.9f}) {
      const std::vector<Point3> corners = {{-5, 0, -0.05f}, {5, 0, -0.05f}, {5, 0, 0.05f}, {-5, 0, 0.05f}};
      const double exact = polygon_irradiance(corners, {along, -height, 0}, {0, 1, 0});
      EXPECT_NEAR(irradiance(light, {along, -height, 0}, {0, 1, 0}) / exact, 1, 5e-3) << height << ' ' << along;
      EXPECT_NEAR(irradiance(across, {0, -height, along}, {0, 1, 0}) / exact, 1, 5e-3) << height << ' ' << along;
    }
}

TEST(MeshLight, TriangleGivesItsSolidAngleAndIrradiance) {
  const Point3 p0(-0.5f, 0, -0.5f), p1(0.9f, 0, -0.4f), p2(0, 0, 0.8f);
  const MeshLight light({triangle(p1, p0, p2)}, Spectrum(1));
  const MeshLight turned({triangle(p0, p1, p2)}, Spectrum(1));
  const MeshLight& down = light.triangles[0].normal.y < 0 ? light : turned;
  for (const Point3& from : places_below(0.012f)) {
    EXPECT_NEAR(sampled_solid_angle(down, from) / triangle_solid_angle(p0, p1, p2, from), 1, 4e-3) << from;
    EXPECT_NEAR(irradiance(down, from, {0, 1, 0}) / polygon_irradiance({p0, p1, p2}, from, {0, 1, 0}), 1, 4e-3) << from;
  }
}

TEST(MeshLight, TwoTrianglesAreTheRectangle) {
  const Point3 a(-0.5f, 0, -0.5f), b(0.5f, 0, -0.5f), c(0.5f, 0, 0.5f), d(-0.5f, 0, 0.5f);
  const MeshLight mesh({triangle(a, b, c), triangle(a, c, d)}, Spectrum(1));
  ASSERT_LT(mesh.triangles[0].normal.y, 0);
  for (const Point3& from : {Point3(0, -1, 0), Point3(0.3f, -0.2f, 1), Point3(0, -10, 0)})
    EXPECT_NEAR(irradiance(mesh, from, {0, 1, 0}) / polygon_irradiance({a, b, c, d}, from, {0, 1, 0}), 1, 4e-3) << from;
}

TEST(MeshLight, TrianglesWithoutAreaAreLeftAlone) {
  const MeshLight::Triangle flat{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, -1, 0}, 0};
  const MeshLight::Triangle one = triangle({0, 0, 0}, {1, 0, 0}, {0, 0, 1});
  const MeshLight light({flat, one, flat}, Spectrum(1));
  EXPECT_NEAR(irradiance(light, {0.2f, -1, 0.2f}, {0, 1, 0}),
              polygon_irradiance({one.p0, one.p1, one.p2}, {0.2f, -1, 0.2f}, {0, 1, 0}), 1e-3);
}

/// A single random number for the triangle and the place on it would leave 16 places on each of a million triangles.
TEST(MeshLight, IsLitEvenlyOnEachOfAMillionTriangles) {
  const MeshLight::Triangle one = triangle({0, 0, 0}, {1, 0, 0}, {0, 0, 1});
  const Light light = MeshLight(std::vector<MeshLight::Triangle>(1 << 20, one), Spectrum(1));
  const Point3 from(0.3f, -30, 0.3f);  // far away: by area
  RunningMean x, z;
  Random random(8);
  for (int i = 0; i < 200000; ++i) {
    const auto s = sample_whole(light, from, random.point(), random.value());
    ASSERT_TRUE(s);
    const Point3 p = from + s->wi * s->distance;
    x.add(p.x);
    z.add(p.z);
  }
  TestFamily family;
  family.add("x", x.p_value(1.0 / 3, 1e-4));
  family.add("z", z.p_value(1.0 / 3, 1e-4));
  EXPECT_TRUE(family.holds());
}

TEST(SphericalTriangle, HasItsSolidAngle) {
  Random random(6);
  for (int i = 0; i < 2000; ++i) {
    const Point3 a = random.direction(), b = random.direction() * 2, c = random.direction() * 0.5f;
    const SphericalTriangle triangle(a, b, c, {0, 0, 0});
    EXPECT_NEAR(triangle.solid_angle(), triangle_solid_angle(a, b, c, {0, 0, 0}), 5e-5);
  }
  // An octant, and one seen from its own plane.
  EXPECT_NEAR(SphericalTriangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}).solid_angle(), kPi / 2, 1e-6);
  EXPECT_EQ(SphericalTriangle({1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, 0, 0}).solid_angle(), 0);
}

TEST(SphericalRectangle, HasItsSolidAngle) {
  // Each face of a cube seen from its middle is a sixth of the sphere.
  EXPECT_NEAR(SphericalRectangle(Rectangle({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}), {0, 0, 0}).solid_angle(), 4 * kPi / 6,
              1e-5);
  EXPECT_NEAR(SphericalRectangle(Rectangle({-1e3f, -1e3f, 1}, {2e3f, 0, 0}, {0, 2e3f, 0}), {0, 0, 0}).solid_angle(),
              2 * kPi, 1e-2);
}

TEST(SphereLight, GivesTheIrradianceOfASphere) {
  // E = π L (r / d)² on a surface that faces the centre and sees the whole sphere.
  for (const float radius : {1e-4f, 0.1f, 1.0f})
    for (const float ratio : {1.001f, 1.1f, 2.0f, 10.0f, 1000.0f}) {
      const SphereLight light{{0, 0, 0}, radius, Spectrum(1)};
      const float d = radius * ratio;
      EXPECT_NEAR(irradiance(light, {0, d, 0}, {0, -1, 0}) * ratio * ratio / std::numbers::pi, 1, 1e-3)
          << radius << ' ' << ratio;
      const double exact = 2 * std::numbers::pi * (1 - std::sqrt(1 - 1 / (static_cast<double>(ratio) * ratio)));
      EXPECT_NEAR(sampled_solid_angle(light, {0, d, 0}, 16) / exact, 1, 1e-3) << radius << ' ' << ratio;
    }
}

TEST(SphereLight, IsDarkFromInside) {
  const SphereLight light{{1, 2, 3}, 2, Spectrum(1)};
  for (const Point3& from : {Point3(1, 2, 3), Point3(1, 2, 4.9f), Point3(2, 2, 3)}) {
    EXPECT_FALSE(sample_whole(light, from, {0.3f, 0.7f}, 0.5f));
    EXPECT_EQ(whole_pdf(light, from, {{1, 2, 5}, {0, 0, 1}}), 0);
  }
}

TEST(SphereLight, SamplesLieOnTheSphereFromVeryClose) {
  const SphereLight light{{0, 0, 0}, 1, Spectrum(1)};
  Random random(7);
  for (const float height : {1e-5f, 1e-4f, 1e-3f, 0.1f, 100.0f}) {
    const Point3 from(0, 1 + height, 0);
    for (int i = 0; i < 2000; ++i) {
      const auto s = sample_whole(light, from, random.point(), 0.5f);
      ASSERT_TRUE(s);
      EXPECT_NEAR((Vec3d(from) + Vec3d(s->wi) * s->distance).length(), 1, 3e-7 * (1 + height)) << height;
    }
  }
}

TEST(AreaLights, BackSidesAreDark) {
  const RectangleLight rectangle{Rectangle({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 0, 1}), Spectrum(1)};
  const MeshLight mesh({triangle({0, 0, 0}, {1, 0, 0}, {0, 0, 1})}, Spectrum(1));
  for (const float y : {0.0f, 1e-3f, 1.0f, 100.0f}) {  // both shine down
    const Point3 from(0.1f, y, 0.1f);
    EXPECT_FALSE(sample_whole(rectangle, from, {0.5f, 0.5f}, 0.5f)) << y;
    EXPECT_FALSE(sample_whole(mesh, from, {0.5f, 0.5f}, 0.5f)) << y;
    EXPECT_EQ(whole_pdf(rectangle, from, {{0, 0, 0}, {0, -1, 0}}), 0) << y;
    EXPECT_EQ(whole_pdf(mesh, from, {{0.2f, 0, 0.2f}, {0, -1, 0}}), 0) << y;
  }
}

TEST(PointLight, FallsOffWithTheSquaredDistance) {
  const PointLight light{{0, 4, 0}, Spectrum(10)};
  EXPECT_NEAR(irradiance(light, {0, 0, 0}, {0, 1, 0}, 1), 10.0 / 16, 1e-6);
  EXPECT_NEAR(irradiance(light, {3, 0, 0}, {0, 1, 0}, 1), 10.0 / 25 * 4 / 5, 1e-6);
  EXPECT_NEAR(sample_whole(light, {3, 0, 0}, {0, 0}, 0)->distance, 5, 1e-6);
  EXPECT_FALSE(sample_whole(light, {0, 4, 0}, {0, 0}, 0));
  EXPECT_NEAR(light_power(light, kScene), 4 * kPi * 10, 1e-3);
}

TEST(SpotLight, ShinesWithinItsCone) {
  SpotLight light;
  light.frame = Transform::rotation({1, 0, 0}, -kPi / 2);  // shines down
  light.frame.origin = {0, 4, 0};
  light.intensity = Spectrum(10);
  light.cutoff = light.beam = radians(40);
  light.exponent = 3;
  EXPECT_NEAR(irradiance(light, {0, 0, 0}, {0, 1, 0}, 1), 10.0 / 16, 1e-6);
  EXPECT_NEAR(irradiance(light, {3, 0, 0}, {0, 1, 0}, 1), 10.0 / 25 * std::pow(4.0 / 5, 3) * 4 / 5, 1e-6);
  EXPECT_FALSE(sample_whole(light, {4, 0, 0}, {0, 0}, 0));  // 45 degrees
  EXPECT_FALSE(sample_whole(light, {0, 5, 0}, {0, 0}, 0));  // behind
}

TEST(DirectionalLight, GivesItsIrradiance) {
  const DirectionalLight light{normalize(Vec3(0, 1, 1)), Spectrum(10)};
  EXPECT_NEAR(irradiance(light, {7, -3, 2}, normalize(Vec3(0, 1, 1)), 1), 10, 1e-5);
  EXPECT_NEAR(irradiance(light, {0, 0, 0}, {0, 1, 0}, 1), 10 * std::sqrt(0.5), 1e-5);
  EXPECT_TRUE(std::isinf(sample_whole(light, {0, 0, 0}, {0, 0}, 0)->distance));
}

TEST(UniformLight, GivesPiFromAbove) {
  const UniformLight light{Spectrum(1), true};
  EXPECT_NEAR(irradiance(light, {0, 0, 0}, {0, 1, 0}), std::numbers::pi, 1e-3);
  EXPECT_NEAR(irradiance(light, {0, 0, 0}, {1, 0, 0}), std::numbers::pi / 2, 1e-3);  // sees half of it
  EXPECT_EQ(irradiance(light, {0, 0, 0}, {0, -1, 0}), 0);
  EXPECT_TRUE(look_at_infinity(light, normalize(Vec3(1, -0.1f, 0))).radiance.is_black());
}

TEST(EnvironmentLight, UniformSkyGivesPi) {
  const Image white(6, 3, Spectrum(1));
  for (const bool importance : {true, false})
    for (const MapOrientation orientation : {MapOrientation{}, MapOrientation{1, true}}) {
      const EnvironmentLight light{white, TexelDistribution(lookup_means(white, orientation.rows())), importance, 1,
                                   orientation};
      for (const Vec3& normal : {Vec3(0, 1, 0), Vec3(0, -1, 0), normalize(Vec3(1, 2, -3))})
        EXPECT_NEAR(irradiance(light, {0, 0, 0}, normal), std::numbers::pi, 5e-3);
      EXPECT_NEAR(sampled_solid_angle(light, {0, 0, 0}), 4 * std::numbers::pi, 1e-2);
    }
}

TEST(EnvironmentLight, ImportanceAndUniformSamplingAgree) {
  for (const MapOrientation orientation : {MapOrientation{}, MapOrientation{2.5f, false}, MapOrientation{1, true}}) {
    const EnvironmentLight important = environment(16, 8, true, orientation),
                           uniform = environment(16, 8, false, orientation);
    for (const Vec3& normal : {Vec3(0, 1, 0), normalize(Vec3(1, -2, 3)), Vec3(-1, 0, 0)}) {
      const double a = irradiance(important, {0, 0, 0}, normal), b = irradiance(uniform, {0, 0, 0}, normal);
      EXPECT_NEAR(a / b, 1, 5e-3);
    }
  }
}

TEST(EnvironmentLight, OneTexelSunIsFoundByImportance) {
  Image map(512, 256);
  map.at(100, 60) = Spectrum(1e6f);
  for (const MapOrientation orientation : {MapOrientation{}, MapOrientation{0, true}}) {
    const EnvironmentLight light{map, TexelDistribution(lookup_means(map, orientation.rows())), true, 1, orientation};
    // The bilinear lookup makes a tent of it, whose integral is that of one cell.
    const bool centered = orientation.rows() == MapRows::centered;
    const double rows = centered ? 256 : 255, v = (centered ? 60.5 : 60.0) / rows;
    const double cell = 2 * std::numbers::pi / 512 * std::numbers::pi / rows * std::sin(std::numbers::pi * v);
    const Vec3 towards = uv_to_direction(orientation, {100.5f / 512, static_cast<float>(v)});
    EXPECT_NEAR(irradiance(light, {0, 0, 0}, towards) / (1e6 * cell), 1, 5e-3);
  }
}

TEST(EnvironmentLight, BlackMapGivesNothingButIsNoTrouble) {
  const Image black(8, 4);
  const EnvironmentLight light{black, TexelDistribution(lookup_means(black, MapRows::pole_to_pole)), true, 1, {}};
  EXPECT_EQ(irradiance(light, {0, 0, 0}, {0, 1, 0}), 0);
  EXPECT_EQ(light_power(light, kScene), 0);
  EXPECT_NEAR(sampled_solid_angle(light, {0, 0, 0}), 4 * std::numbers::pi, 1e-2);
}

TEST(LightPower, IsTheEmittedFlux) {
  // Rough by contract, but exact for Lambertian surfaces: π times area times radiance.
  const float pi = kPi;
  EXPECT_NEAR(light_power(RectangleLight{Rectangle({0, 0, 0}, {2, 0, 0}, {0, 3, 0}), Spectrum(1)}, kScene), pi * 6,
              1e-4);
  EXPECT_NEAR(light_power(MeshLight(cube(), Spectrum(1)), kScene), pi * 6, 1e-4);
  EXPECT_NEAR(light_power(SphereLight{{0, 0, 0}, 2, Spectrum(1)}, kScene), pi * 16 * pi, 1e-3);
}

/// The flux through the scene's disk is the integral of the radiance over the sphere, rows where the mapping has them.
TEST(LightPower, OfAnEnvironmentIsWhatIsSeenOfIt) {
  Image zenith(8, 12), belt(8, 12);
  for (int x = 0; x < 8; ++x) {
    for (const int y : {0, 1, 2}) zenith.at(x, y) = Spectrum(100);
    for (const int y : {3, 4}) belt.at(x, y) = Spectrum(3);
  }
  for (const Image& map : {zenith, belt})
    for (const bool mirrored : {false, true}) {
      const MapOrientation orientation{0.4f, mirrored};
      const EnvironmentLight light{map, TexelDistribution(lookup_means(map, orientation.rows())), true, 2, orientation};
      const double seen = integrate(
          [&](double v) {
            return light.look(uv_to_direction(orientation, {0.3f, static_cast<float>(v)})).radiance.luminance() *
                   std::sin(std::numbers::pi * v);
          },
          0, 1, 1e-5);
      const double disk = std::numbers::pi * square(0.5f * kScene.diagonal());
      EXPECT_NEAR(light_power(light, kScene) / (2 * std::numbers::pi * std::numbers::pi * seen * disk), 1, 0.05)
          << mirrored;
    }
}

}  // namespace
}  // namespace etendue
