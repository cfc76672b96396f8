// Radiance is proportional to the squared index: η² times as much within glass, and the same again outside.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/tests/temporary_folder.h"
#include "picture_statistics.h"
#include "scene_kit.h"

namespace etendue {
namespace {

constexpr float kIor = 1.5f;

/// Fresnel's equations for a smooth boundary, unpolarised; cosine on the side with index 1, the other side has `index`.
double fresnel(double cos_outside, double index) {
  const double cos_inside = std::sqrt(1 - (1 - cos_outside * cos_outside) / (index * index));
  const double s = (cos_outside - index * cos_inside) / (cos_outside + index * cos_inside);
  const double p = (index * cos_outside - cos_inside) / (index * cos_outside + cos_inside);
  return 0.5 * (s * s + p * p);
}

MaterialId glass(SceneKit& kit) {
  return kit.material(scene::GlassMaterial{Spectrum(1), Spectrum(1), kIor});
}
MaterialId refraction(SceneKit& kit) {
  return kit.material(scene::RefractionMaterial{Spectrum(1), kIor});
}

/// A level boundary at y = 0, glass below, far beyond what is seen, under a sky of radiance 1.
SceneKit under_the_sky(MaterialId (*boundary)(SceneKit&)) {
  SceneKit kit;
  kit.quad({-100, 0, 100}, {200, 0, 0}, {0, 0, -200}, boundary(kit));
  kit.light(scene::HemisphereLight{Spectrum(1)});
  return kit;
}

/// Sine of the angle to the vertical at which the middle of a pixel is seen by an upward camera.
double sine_at(const Camera& camera, int x, int y, int size) {
  const auto offset = [&](int i) { return (2 * (i + 0.5) / size - 1) * camera.tan_half_x; };
  const double tan = std::hypot(offset(x), offset(y));
  return tan / std::sqrt(1 + tan * tan);
}

TEST(GlassRadiance, SnellsWindowFromBelowIsBrighterByTheSquaredIndex) {
  constexpr int kSize = 48;
  const Camera camera = pinhole({0, -1, 0}, {0, 0, 0}, 1.2f);
  const double blur = 2.0 * 1.2 / kSize;  // a pixel's diagonal in tangents, and more
  const SampledPicture with_fresnel =
      sampled_picture(render(under_the_sky(glass).compile(), camera, square_settings(kSize, 256)));
  const SampledPicture without =
      sampled_picture(render(under_the_sky(refraction).compile(), camera, square_settings(kSize, 16)));
  TestFamily tests;
  int bright = 0, dark = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double sin_inside = sine_at(camera, x, y, kSize), sin_outside = sin_inside * kIor;
      if (sin_outside > 1 + kIor * blur) {  // total reflection: the dark below
        ++dark;
        EXPECT_EQ(with_fresnel.mean.at(x, y), Spectrum(0)) << x << ", " << y;
        EXPECT_EQ(without.mean.at(x, y), Spectrum(0)) << x << ", " << y;
      } else if (sin_outside < 0.9 - kIor * blur) {  // F hardly changes within a pixel
        ++bright;
        EXPECT_NEAR(without.mean.at(x, y).g, kIor * kIor, 1e-5) << x << ", " << y;
        const double expected = kIor * kIor * (1 - fresnel(std::sqrt(1 - sin_outside * sin_outside), kIor));
        tests.add(fmt::format("pixel {}, {}", x, y),
                  region_mean(with_fresnel, {x, y, 1, 1}, 1).p_value(expected, 0.02));
      }
    }
  EXPECT_GT(bright, 200);
  EXPECT_GT(dark, 200);
  EXPECT_TRUE(tests.holds());
}

TEST(GlassRadiance, InTheMiddleOfAGlassBallTheWorldIsBrighterByTheSquaredIndex) {
  TemporaryFolder folder;
  SceneKit kit;
  kit.light(environment_map(folder / "white.exr", Image(4, 3, Spectrum(1))));
  kit.sphere({0.2f, -0.1f, 0.3f}, 0.8f, glass(kit));
  const Picture picture = render(kit.compile(), pinhole({0.2f, -0.1f, 0.3f}, {1, 1, 1}, 1), square_settings(32, 64));
  TestFamily tests;
  const RunningMean mean = over_pixels(picture.beauty, 0);
  EXPECT_LT(mean.standard_error(), 0.0005);
  tests.add("mean",
            mean.p_value(kIor * kIor, 1e-5));  // reflected inwards with F, then again and again: (1 − F) Σ Fⁿ = 1
  EXPECT_TRUE(tests.holds());
}

TEST(GlassRadiance, LightTrappedInABallNeverLeaves) {
  TemporaryFolder folder;
  SceneKit kit;
  kit.light(environment_map(folder / "white.exr", Image(4, 3, Spectrum(1))));
  kit.sphere({0, 0, 0}, 1, glass(kit));
  // At 0.9 of the radius, looking sideways: the boundary is met at sin θ = 0.9 > 1/η, for ever.
  const Picture picture = render(kit.compile(), pinhole({0.9f, 0, 0}, {0.9f, 0, 1}, 0.1f), square_settings(16, 16));
  for (const Spectrum& s : picture.beauty.pixels()) EXPECT_EQ(s, Spectrum(0));
}

/// A pane with parallel faces at y = 0 and y = −1 over an emitter of radiance 1.
SceneKit pane_over_emitter(MaterialId (*boundary)(SceneKit&)) {
  SceneKit kit;
  const MaterialId face = boundary(kit);
  kit.quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, face);
  kit.quad({-50, -1, -50}, {100, 0, 0}, {0, 0, 100}, face);
  kit.quad({-50, -2, 50}, {100, 0, 0}, {0, 0, -100}, kit.emitter(Spectrum(1)));
  return kit;
}

TEST(GlassRadiance, APaneGivesBackWhatItTook) {
  TestFamily tests;
  for (const float angle_deg : {0.0f, 45.0f, 70.0f}) {
    const float angle = radians(angle_deg);
    const Camera camera = pinhole({2 * std::sin(angle), 2 * std::cos(angle), 0}, {0, 0, 0}, 1e-3f);
    const Picture clear = render(pane_over_emitter(refraction).compile(), camera, square_settings(8, 16));
    for (const Spectrum& s : clear.beauty.pixels()) EXPECT_NEAR(s.g, 1, 2e-6);

    const double f = fresnel(std::cos(static_cast<double>(angle)), kIor);
    const Picture reflecting = render(pane_over_emitter(glass).compile(), camera, square_settings(32, 128));
    const RunningMean mean = over_pixels(reflecting.beauty, 1);
    EXPECT_LT(mean.standard_error(), 0.002);
    tests.add(fmt::format("{} degrees: {} instead of {}", angle_deg, mean.mean(), (1 - f) / (1 + f)),
              mean.p_value((1 - f) / (1 + f), 1e-4));  // (1 − F)² Σ F²ⁿ
  }
  EXPECT_TRUE(tests.holds());
}

TEST(GlassRadiance, AnEmitterUnderGlassIsDimmerByTheSquaredIndex) {
  SceneKit kit;
  kit.quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, refraction(kit));
  kit.quad({-50, -1, 50}, {100, 0, 0}, {0, 0, -100}, kit.emitter(Spectrum(1)));
  const Picture picture = render(kit.compile(), pinhole({1, 2, 0}, {0, 0, 0}, 0.1f), square_settings(8, 16));
  for (const Spectrum& s : picture.beauty.pixels()) EXPECT_NEAR(s.g, 1 / (kIor * kIor), 1e-6);
}

}  // namespace
}  // namespace etendue
