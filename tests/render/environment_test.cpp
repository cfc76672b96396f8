// Environment maps: whatever the sampling, the same picture; and the maps that break renderers.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/tests/temporary_folder.h"
#include "picture_statistics.h"
#include "render/session.h"
#include "scene_kit.h"
#include "testing/quadrature.h"
#include "testing/random.h"

namespace etendue {
namespace {

constexpr double kPiD = std::numbers::pi;

/// A bright sky over dark ground with a sun of 2 × 2 texels, 260 times as bright.
Image outdoor_map() {
  Image map(32, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x)
      map.at(x, y) =
          y < 8 ? Spectrum(0.4f, 0.5f, 0.8f) * (0.5f + 0.5f * static_cast<float>(y) / 8) : Spectrum(0.1f, 0.08f, 0.05f);
  for (int y = 4; y < 6; ++y)
    for (int x = 20; x < 22; ++x) map.at(x, y) = Spectrum(200, 180, 140);
  return map;
}

/// A diffuse and a metal sphere on diffuse ground.
SceneKit still_life() {
  SceneKit kit;
  kit.quad({-4, -1, 4}, {8, 0, 0}, {0, 0, -8}, kit.diffuse(Spectrum(0.5f, 0.4f, 0.3f)));
  kit.sphere({-1.1f, 0, 0}, 1, kit.diffuse(Spectrum(0.7f)));
  kit.sphere({1.1f, 0, 0}, 1,
             kit.material(scene::ConductorMaterial{Spectrum(0.2f, 0.92f, 1.1f), Spectrum(3.9f, 2.45f, 2.14f), 0.3f,
                                                   0.3f, scene::Microfacets::beckmann, Spectrum(1)}));
  return kit;
}

const Camera kBeforeStillLife = pinhole({0, 1.5f, 6}, {0, 0, 0}, 0.45f);

SampledPicture with_sampling(const SceneKit& kit, EnvironmentSampling sampling, const RenderSettings& settings,
                             const Camera& camera = kBeforeStillLife) {
  return sampled_picture(render(kit.compile({.fresnel = {}, .environment_sampling = sampling}), camera, settings));
}

double mean_variance(const SampledPicture& picture) {
  double sum = 0;
  for (const Spectrum& v : picture.variance.pixels()) sum += v.luminance();
  return sum / static_cast<double>(picture.variance.pixels().size());
}

void expect_agreement(const SampledPicture& a, const SampledPicture& b) {
  const WelchTest pixels = welch_test(a, b);
  EXPECT_GE(pixels.agreeing_share, kAgreeingShare);
  EXPECT_LT(pixels.rms_t, 1.1);
  for (int c = 0; c < 3; ++c)
    EXPECT_GT(normal_p(pixels.mean_difference_sigmas[c]), sidak(0.01, 3)) << "of the whole picture, channel " << c;
}

TEST(Environment, UniformAndImportanceSamplingAgreeAndImportanceIsQuieter) {
  TemporaryFolder folder;
  SceneKit kit = still_life();
  kit.light(environment_map(folder / "outdoor.exr", outdoor_map()));
  const SampledPicture importance = with_sampling(kit, EnvironmentSampling::importance, square_settings(40, 256));
  const SampledPicture uniform = with_sampling(kit, EnvironmentSampling::uniform, square_settings(40, 1024));
  expect_agreement(importance, uniform);
  // The sun is 0.7 % of the sphere and gives most of the light: uniform directions miss it 143 times in 144.
  EXPECT_LT(mean_variance(importance), 0.1 * mean_variance(uniform));

  RenderSettings by_directions = square_settings(40, 256);
  by_directions.integrator = IntegratorKind::hemisphere;
  by_directions.light_samples = 4;
  expect_agreement(importance, with_sampling(kit, EnvironmentSampling::importance, by_directions));

  RenderSettings many_light_samples = square_settings(40, 64);
  many_light_samples.light_samples = 4;
  expect_agreement(importance, with_sampling(kit, EnvironmentSampling::importance, many_light_samples));
}

TEST(Environment, SamplingsAgreeForTheMirroredMappingToo) {
  TemporaryFolder folder;
  SceneKit kit = still_life();
  scene::EnvironmentLight light = environment_map(folder / "outdoor.exr", outdoor_map());
  light.mirrored = true;
  light.rotation_deg = 70;
  kit.light(light);
  expect_agreement(with_sampling(kit, EnvironmentSampling::importance, square_settings(32, 128)),
                   with_sampling(kit, EnvironmentSampling::uniform, square_settings(32, 1024)));
}

/// Level ground seen from above, albedo 0.5.
SceneKit ground(const scene::EnvironmentLight& environment) {
  SceneKit kit;
  kit.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, kit.diffuse(Spectrum(0.5f)));
  kit.light(environment);
  return kit;
}
const Camera kAboveGround = pinhole({1, 2, 1}, {0, 0, 0}, 1e-3f);

TEST(Environment, AOneTexelSunLightsTheGroundAsItsIntegralSays) {
  constexpr int kWidth = 32, kHeight = 17, kColumn = 9, kRow = 5;
  TemporaryFolder folder;
  Image map(kWidth, kHeight);
  map.at(kColumn, kRow) = Spectrum(50);
  const SceneKit kit = ground(environment_map(folder / "sun.exr", map));

  // Bilinear lookup makes the texel a tent; its row stands at v = row / (height − 1).
  const auto tent = [](double x) { return std::max(0.0, 1 - std::abs(x)); };
  const double step = kPiD / (kHeight - 1), theta = kRow * step;
  const auto row = [&](double t) { return tent((t - theta) / step) * std::cos(t) * std::sin(t); };
  const double irradiance = 50 * 2 * kPiD / kWidth *
                            (integrate(row, theta - step, theta, 1e-10) + integrate(row, theta, theta + step, 1e-10));

  TestFamily tests;
  for (const EnvironmentSampling sampling : {EnvironmentSampling::uniform, EnvironmentSampling::importance}) {
    const bool uniform = sampling == EnvironmentSampling::uniform;
    const SampledPicture picture = with_sampling(kit, sampling, square_settings(32, uniform ? 1024 : 96), kAboveGround);
    const RunningMean mean = over_pixels(picture.mean, 0);
    const double expected = 0.5 * irradiance / kPiD;
    EXPECT_LT(mean.standard_error(), (uniform ? 0.015 : 0.004) * expected);
    tests.add(fmt::format("uniform {}: {} instead of {}", uniform, mean.mean(), expected),
              mean.p_value(expected, 1e-4 * expected));
  }
  EXPECT_TRUE(tests.holds());
}

TEST(Environment, MapsOfOddSizesAgree) {
  TemporaryFolder folder;
  Random random(7);
  for (const auto& [width, height] :
       {std::pair(7, 5), std::pair(1, 9), std::pair(9, 1), std::pair(1, 2), std::pair(2, 2)}) {
    SCOPED_TRACE(fmt::format("{} × {}", width, height));
    Image map(width, height);
    for (Spectrum& s : map.pixels()) s = Spectrum(random.value(), random.value(), random.value()) * 3;
    SceneKit kit = still_life();
    kit.light(environment_map(folder / "odd.exr", map));
    expect_agreement(with_sampling(kit, EnvironmentSampling::importance, square_settings(24, 128)),
                     with_sampling(kit, EnvironmentSampling::uniform, square_settings(24, 128)));
  }
}

TEST(Environment, AOneTexelMapIsUniformLight) {
  TemporaryFolder folder;
  const Spectrum radiance(1, 0.5f, 2);
  const SceneKit kit = ground(environment_map(folder / "one.exr", Image(1, 1, radiance)));
  const SampledPicture picture =
      with_sampling(kit, EnvironmentSampling::importance, square_settings(32, 64), kAboveGround);
  TestFamily tests;
  for (int c = 0; c < 3; ++c) tests.add("channel", over_pixels(picture.mean, c).p_value(0.5 * radiance[c], 1e-5));
  EXPECT_TRUE(tests.holds());
}

/// Compiles with the expectation of exactly one warning that contains `part`.
RenderScene compile_with_warning(const SceneKit& kit, const std::string& part) {
  Diagnostics diagnostics;
  RenderScene scene = compile(kit.description(), {}, diagnostics);
  EXPECT_EQ(diagnostics.all().size(), 1u);
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    EXPECT_EQ(diagnostic.severity, Severity::warning);
    EXPECT_NE(diagnostic.message.find(part), std::string::npos) << diagnostic.message;
  }
  return scene;
}

TEST(Environment, ABlackMapIsWarnedAboutAndGivesABlackPicture) {
  TemporaryFolder folder;
  const SceneKit kit = ground(environment_map(folder / "black.exr", Image(8, 4)));
  const RenderScene scene = compile_with_warning(kit, "black.exr: the environment map is all black");
  const Picture picture = render(scene, kAboveGround, square_settings(8, 4));
  for (const Spectrum& s : picture.beauty.pixels()) EXPECT_EQ(s, Spectrum(0));
}

TEST(Environment, InvalidTexelsAreWarnedAboutAndCountAsBlack) {
  TemporaryFolder folder;
  Image map = outdoor_map(), repaired = map;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  map.at(3, 2) = Spectrum(kNan);
  map.at(4, 7) = Spectrum(1, -2, 1);
  map.at(30, 12) = Spectrum(1, 1, kInfinity);
  repaired.at(3, 2) = Spectrum(0);
  repaired.at(4, 7) = Spectrum(1, 0, 1);
  repaired.at(30, 12) = Spectrum(1, 1, 0);

  const RenderScene scene =
      compile_with_warning(ground(environment_map(folder / "bad.exr", map)), "3 texels are NaN, infinite or negative");
  const RenderScene expected = ground(environment_map(folder / "good.exr", repaired)).compile();
  EXPECT_TRUE(identical(render(scene, kAboveGround, square_settings(8, 16)),
                        render(expected, kAboveGround, square_settings(8, 16))));
}

}  // namespace
}  // namespace etendue
