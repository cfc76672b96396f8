#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "light_kit.h"

namespace etendue {
namespace {

/// A picture with a bright corner on a dim ground.
Image spotted() {
  Image image(16, 8, Spectrum(0.1f, 0.2f, 0.3f));
  for (int y = 0; y < 3; ++y)
    for (int x = 9; x < 14; ++x) image.at(x, y) = Spectrum(30, 20, 10);
  return image;
}

const Textures& textures() {
  static const Textures made = {BitmapTexture{Texels(spotted())}};
  return made;
}

/// A quad of two triangles with texture coordinates, in the plane y = 0, its front downwards.
TriangleMesh quad() {
  TriangleMesh mesh;
  mesh.positions = {{-1, 0, -1}, {2, 0, -1}, {2, 0, 1}, {-1, 0, 1}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Irradiance at a point of a surface with this normal, by the light's samples.
double sampled_irradiance(const Light& light, const Point3& from, const Vec3& normal, int n) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, kOneMinusEpsilon);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const Vec2 u(uniform(random), uniform(random));
    const auto sample = sample_whole(light, from, u, uniform(random));
    if (sample) sum += sample->radiance.g * std::max(0.0f, dot(sample->wi, normal)) / sample->pdf;
  }
  return sum / n;
}

/// The same by rays in all directions that meet the geometry: knows nothing of how the light is sampled.
double traced_irradiance(const Geometry& geometry, const Glow& glow, const Point3& from, const Vec3& normal, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const float z = 1 - 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(n), r = std::sqrt(1 - z * z);
      const float phi = 2 * kPi * (static_cast<float>(j) + 0.5f) / static_cast<float>(n);
      const Vec3 w(r * std::cos(phi), z, r * std::sin(phi));
      if (dot(w, normal) <= 0) continue;
      const Ray ray{from, w};
      const RayHit hit = geometry.intersect(ray);
      if (!hit.found()) continue;
      const SurfaceHit surface = geometry.surface(ray, hit);
      if (dot(surface.geometric_normal, w) < 0) sum += glow.at(hit, surface).g * dot(w, normal);
    }
  return sum * 4 * kPi / (static_cast<double>(n) * n);
}

/// Every sample's density is what pdf_hit says of the point that a ray finds there.
void expect_densities_agree(const Geometry& geometry, const Light& light, const Point3& from) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.001f, 0.999f);
  int seen = 0, differing = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec2 u(uniform(random), uniform(random));
    const auto sample = sample_whole(light, from, u, uniform(random));
    if (!sample) continue;
    const Ray ray{from, sample->wi};
    const RayHit hit = geometry.intersect(ray);
    if (!hit.found() || std::abs(hit.t - sample->distance) > 1e-3f * sample->distance) continue;
    const SurfaceHit surface = geometry.surface(ray, hit);
    const LightHit on_light{surface.position, surface.geometric_normal, hit.primitive, hit.u, hit.v};
    ++seen;
    // At the border of two small triangles rounding may choose either.
    differing += std::abs(whole_pdf(light, from, on_light) - sample->pdf) > 2e-3f * sample->pdf ? 1 : 0;
  }
  EXPECT_GT(seen, 100);
  EXPECT_LE(differing, seen / 100);
}

void check(Geometry& geometry, const Point3& from, const Vec3& normal, const ColorSource& radiance,
           double tolerance = 0.01) {
  geometry.build();
  const Glow glow{&geometry, &textures(), 0, radiance};
  const Light light =
      geometry.kind(0) == Geometry::Kind::mesh ? Light(TexturedMeshLight(glow)) : Light(CurvedLight(glow));
  const double traced = traced_irradiance(geometry, glow, from, normal, 1500);
  EXPECT_NEAR(sampled_irradiance(light, from, normal, 400'000) / traced, 1, tolerance);
  expect_densities_agree(geometry, light, from);
}

TEST(TexturedMeshLight, GivesWhatRaysFind) {
  for (const Point3& from : {Point3(0, -2, 0), Point3(1.3f, -0.4f, 0.5f), Point3(-3, -1, 2)}) {
    Geometry geometry;
    geometry.add(quad());
    check(geometry, from, normalize(Vec3(0.2f, 1, 0.1f)), std::uint32_t{0});
  }
}

TEST(TexturedMeshLight, ChoosesItsBrightPart) {
  Geometry geometry;
  geometry.add(quad());
  geometry.build();
  const Light light = TexturedMeshLight(Glow{&geometry, &textures(), 0, std::uint32_t{0}});
  int bright = 0;
  constexpr int kSamples = 2000;
  for (int i = 0; i < kSamples; ++i) {
    const auto sample = sample_whole(light, {0, -2, 0}, {0.3f, 0.6f}, (static_cast<float>(i) + 0.5f) / kSamples);
    ASSERT_TRUE(sample);
    bright += sample->radiance.g > 10 ? 1 : 0;
  }
  // 12 % of the area, 95 % of the light; 5 % of the samples ignore brightness.
  EXPECT_GT(bright, 0.75 * kSamples);
}

TEST(CurvedLight, DisksCylindersAndSpheresGiveWhatRaysFind) {
  const Transform squashed{{2, 0, 0}, {0, 0, 0.7f}, {0, -1, 0}, {0.3f, 0, 0.2f}};  // the disk's front points down
  for (const ColorSource& radiance : {ColorSource(Spectrum(3)), ColorSource(std::uint32_t{0})}) {
    const double tolerance = std::holds_alternative<Spectrum>(radiance) ? 0.01 : 0.02;
    Geometry disk, cylinder, inside, sphere;
    disk.add(DiskShape{squashed});
    check(disk, {0, -1, 0}, {0, 1, 0}, radiance, tolerance);
    cylinder.add(CylinderShape{squashed});
    check(cylinder, {4, -1, 1}, normalize(Vec3(-1, 0.3f, 0)), radiance, tolerance);
    inside.add(SphereShape{{0, 0, 0}, 2, {0, 1, 0}, {1, 0, 0}, true});
    check(inside, {0.5f, 0.3f, 0}, {0, 1, 0}, radiance, tolerance);
    sphere.add(SphereShape{{0, 3, 0}, 1});
    check(sphere, {0, 0, 0}, {0, 1, 0}, radiance, tolerance);
  }
}

TEST(ProjectorLight, GivesItsPictureToAPlaneAtDistanceOne) {
  ProjectorLight projector;  // shines along −z
  projector.tan_half_x = 0.5f;
  projector.tan_half_y = 0.25f;
  projector.scale = 2;
  projector.picture = Spectrum(3);
  for (const Vec2& at : {Vec2(0, 0), Vec2(0.4f, -0.2f), Vec2(-0.49f, 0.24f)}) {
    const auto sample = projector.sample({at.x, at.y, -1}, {0, 0});
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->radiance.g * sample->wi.z, 6, 1e-4);  // the cosine on that plane
  }
  EXPECT_FALSE(projector.sample({0.51f, 0, -1}, {0, 0}));
  EXPECT_FALSE(projector.sample({0, 0, 1}, {0, 0}));
}

TEST(ProjectorLight, ShowsItsPictureUpright) {
  ProjectorLight projector;
  projector.textures = &textures();
  projector.picture = std::uint32_t{0};
  // The picture's bright part lies right and up, as seen from the projector.
  EXPECT_GT(projector.sample({0.5f, 0.7f, -1}, {0, 0})->radiance.g, 5);
  EXPECT_LT(projector.sample({-0.5f, 0.7f, -1}, {0, 0})->radiance.g, 1);
  EXPECT_LT(projector.sample({0.5f, -0.7f, -1}, {0, 0})->radiance.g, 1);
}

TEST(SpotLight, FallsFromTheBeamToTheCutoff) {
  SpotLight spot;
  spot.intensity = Spectrum(1);
  spot.cutoff = radians(40);
  spot.beam = radians(20);
  const auto at = [&](float degrees) {
    const auto sample = spot.sample({std::sin(radians(degrees)), 0, -std::cos(radians(degrees))}, {0, 0});
    return sample ? sample->radiance.g : 0.0f;
  };
  EXPECT_NEAR(at(10), 1, 1e-5);
  EXPECT_NEAR(at(25), 0.75f, 1e-4);
  EXPECT_NEAR(at(35), 0.25f, 1e-4);
  EXPECT_EQ(at(41), 0);
}

}  // namespace
}  // namespace etendue
