// Bright dots that nothing around bears out are left out; what many samples saw stays, and so does, in the end, all
// light.

#include <gtest/gtest.h>

#include <cmath>

#include "picture_statistics.h"
#include "render/film.h"
#include "technique_comparison.h"
#include "testing/random.h"

namespace etendue {
namespace {

constexpr int kSide = 24;

/// Each sample's radiance by `draw`, the same for both ways to look at it.
template <typename Draw>
std::pair<Image, Image> raw_and_doubted(int samples, Draw draw) {
  Film raw(kSide, kSide), doubting(kSide, kSide, false, true);
  Random random(1);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int i = 0; i < samples; ++i) {
        PixelSample sample;
        sample.radiance = draw(random, x, y, i);
        raw.add(x, y, std::span(&sample, 1), 0);
        doubting.add(x, y, std::span(&sample, 1), 0);
      }
  return {raw.beauty(), doubting.beauty()};
}

Spectrum noise(Random& random) {
  return Spectrum(0.2f, 0.1f, 0.3f) * (2 * random.value());
}

double mean(const Image& image) {
  return over_pixels(image, 0).mean();
}

TEST(Outliers, DotsVanish) {
  for (const int samples : {4, 64}) {
    const auto dot = [](int x, int y) { return x % 8 == 3 && y % 8 == 0; };
    const auto [clean, unused] = raw_and_doubted(samples, [](Random& random, int, int, int) { return noise(random); });
    const auto [raw, doubted] = raw_and_doubted(samples, [&](Random& random, int x, int y, int i) {
      return noise(random) +
             (dot(x, y) && i == 1 ? Spectrum(300, 2e4f, 700) * std::exp2(static_cast<float>(x + y) / 4) : Spectrum(0));
    });
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        for (int c = 0; c < 3; ++c) {
          if (dot(x, y)) {
            EXPECT_GT(raw.at(x, y)[c], 4 * clean.at(x, y)[c]);
          }
          // The sample of the dot goes as a whole.
          EXPECT_NEAR(doubted.at(x, y)[c], clean.at(x, y)[c], dot(x, y) ? 0.7 / samples : 1e-6) << x << ", " << y;
        }
  }
}

TEST(Outliers, ACleanPictureStaysAsItIs) {
  for (const int samples : {8, 64}) {
    const auto [raw, doubted] = raw_and_doubted(samples, [](Random& random, int x, int y, int) {
      // A small lamp, an edge, and black.
      if (x == 5 && y == 5) return Spectrum(1000);
      return x < 12 ? noise(random) : y < 12 ? noise(random) * 50 : Spectrum(0);
    });
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        EXPECT_NEAR(doubted.at(x, y).r, raw.at(x, y).r, 1e-6 * raw.at(x, y).r) << x << ", " << y;
  }
}

/// A third of the light comes by one sample in 200.
TEST(Outliers, LeaveOutLessAndLess) {
  double before = 1;
  for (const int samples : {4, 64, 1024}) {
    const auto [raw, doubted] = raw_and_doubted(
        samples, [](Random& random, int, int, int) { return Spectrum(random.value() < 0.005f ? 100.0f : 1.0f); });
    const double loss = 1 - mean(doubted) / mean(raw);
    EXPECT_LT(loss, 0.5 * before) << samples;
    before = loss;
    if (samples == 4) {
      EXPECT_GT(loss, 0.2);
    }
  }
  EXPECT_LT(before, 1e-4);
}

TEST(Outliers, NegativeLobesAreCopedWith) {
  const auto [raw, doubted] = raw_and_doubted(16, [](Random& random, int x, int y, int i) {
    return noise(random) - (x == 7 && y == 9 && i == 3 ? Spectrum(1e6f) : Spectrum(0));
  });
  EXPECT_LT(raw.at(7, 9).r, -1e3f);
  EXPECT_NEAR(doubted.at(7, 9).r, 0.2f, 0.2f);
}

/// Light of a small lamp through glass, found by chance: the picture comes nearer to the truth.
TEST(Outliers, FirefliesOfCausticsAreFewer) {
  SceneKit kit;
  kit.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, kit.diffuse(Spectrum(0.6f)));
  kit.sphere({0, 0.7f, 0}, 0.5f, glass(kit));
  kit.sphere({0, 2.5f, 0.5f}, 0.05f, kit.emitter(Spectrum(300)));
  const RenderScene scene = kit.compile();
  const Camera camera = pinhole({0, 1.5f, 3}, {0, 0.3f, 0}, 0.5f);
  RenderSettings settings = square_settings(64, 1024);
  settings.integrator = IntegratorKind::automatic;
  const Image truth = render(scene, camera, settings).beauty;
  settings = square_settings(64, 32);
  const Image raw = render(scene, camera, settings).beauty;
  settings.doubts_outliers = true;
  const Image doubted = render(scene, camera, settings).beauty;
  EXPECT_LT(measure_error(doubted, truth).mse, 0.7 * measure_error(raw, truth).mse);
}

}  // namespace
}  // namespace etendue
