// Adaptive sampling stops where its criterion says, and changes no picture by more than it promises.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "image/false_color.h"
#include "picture_statistics.h"
#include "render/session.h"
#include "scene_kit.h"

namespace etendue {
namespace {

constexpr int kSize = 40, kMost = 1024;
constexpr AdaptiveSampling kAdaptive{32, 0.1f};

/// Grey, so that every channel is the luminance: a lamp over ground, half in the shadow of a board, and the void.
class Adaptive : public ::testing::Test {
 protected:
  Adaptive() {
    SceneKit kit;
    kit.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, kit.diffuse(Spectrum(0.6f)));
    kit.quad({0, 0.6f, 0.5f}, {1, 0, 0}, {0, 0, -1.5f}, kit.diffuse(Spectrum(0.3f)));
    kit.quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, kit.emitter(Spectrum(4)));
    scene = std::make_unique<RenderScene>(kit.compile());
    settings = square_settings(kSize, kMost);
    settings.adaptive = kAdaptive;
  }

  std::unique_ptr<RenderScene> scene;
  Camera camera = pinhole({0, 1.5f, 6}, {0, 0.6f, 0}, 0.6f);
  RenderSettings settings;
};

/// 1.96 σ/√n ≤ tolerance · mean, recomputed from what the picture says; `slack` for its float channels.
bool settled(const SampledPicture& picture, std::size_t i, double slack) {
  const double error = std::sqrt(picture.variance.pixels()[i].g / picture.samples[i]);
  return 1.96 * error <= kAdaptive.tolerance * picture.mean.pixels()[i].g * (1 + slack) + 1e-9;
}

TEST_F(Adaptive, StopsWithTheFirstBatchThatMeetsTheCriterion) {
  const SampledPicture adaptive = sampled_picture(render(*scene, camera, settings));
  RenderSettings steady = settings;
  steady.adaptive = {};
  RenderSession session(*scene, camera, steady);
  std::vector<bool> stopped(adaptive.samples.size(), false);
  std::size_t early = 0;
  for (int samples = kAdaptive.batch; samples <= kMost; samples += kAdaptive.batch) {
    session.render_pass({}, kAdaptive.batch);
    const SampledPicture so_far = sampled_picture(session.snapshot());
    for (std::size_t i = 0; i < stopped.size(); ++i) {
      if (stopped[i]) continue;
      const bool stops_here = static_cast<int>(adaptive.samples[i]) == samples;
      if (stops_here) {
        EXPECT_EQ(adaptive.mean.pixels()[i], so_far.mean.pixels()[i]) << "pixel " << i;
      }
      if (stops_here && samples < kMost) {
        EXPECT_TRUE(settled(so_far, i, 1e-4)) << "pixel " << i << " stopped at " << samples;
        ++early;
      } else if (!stops_here) {
        EXPECT_FALSE(settled(so_far, i, -1e-4)) << "pixel " << i << " went on after " << samples;
      }
      stopped[i] = stops_here;
    }
  }
  EXPECT_TRUE(std::ranges::all_of(stopped, [](bool s) { return s; }));
  EXPECT_GT(early, stopped.size() / 4);
}

TEST_F(Adaptive, TakesFewSamplesWhereItIsEasyAndManyInThePenumbra) {
  const SampledPicture picture = sampled_picture(render(*scene, camera, settings));
  const auto samples_at = [&](const Point3& world) {
    const Vec2 film = project(camera, world).film * static_cast<float>(kSize);
    return picture.samples[static_cast<std::size_t>(film.y) * kSize + static_cast<std::size_t>(film.x)];
  };
  EXPECT_EQ(picture.samples[kSize / 2], kAdaptive.batch) << "nothing is seen at the top: no noise";
  EXPECT_LE(samples_at({-2, 0, 1}), 256) << "open ground";
  EXPECT_GT(samples_at({0.3f, 0, 0.2f}), 2 * samples_at({-2, 0, 1})) << "beneath the board";
}

TEST_F(Adaptive, AgreesWithTheSteadyPicture) {
  const SampledPicture adaptive = sampled_picture(render(*scene, camera, settings));
  RenderSettings steady = settings;
  steady.adaptive = {};
  steady.seed = 1;
  const SampledPicture reference = sampled_picture(render(*scene, camera, steady));
  const WelchTest pixels = welch_test(adaptive, reference);
  EXPECT_GE(pixels.agreeing_share, kAgreeingShare);
  // Stopping when the error seems small favours samples that seem to agree with each other: a bias well below the
  // tolerance.
  const auto luminance = [](const SampledPicture& p) { return region_luminance(p, [](int, int) { return true; }); };
  const RegionMean a = luminance(adaptive), b = luminance(reference);
  EXPECT_GT(a.p_value(b, 0.1 * kAdaptive.tolerance * b.mean), 0.01) << a.mean << " instead of " << b.mean;
}

TEST_F(Adaptive, TheRatePictureShowsTheSamples) {
  RenderSession session(*scene, camera, settings);
  while (!session.finished()) session.render_pass({}, 0);
  const SampledPicture picture = sampled_picture(session.snapshot());
  const Image rate = session.sample_rate_picture();
  std::size_t few = 0, most = 0;
  double taken = 0;
  for (std::size_t i = 0; i < picture.samples.size(); ++i) {
    const Spectrum& color = rate.pixels()[i];
    taken += picture.samples[i];
    EXPECT_EQ(color, rate_color(picture.samples[i] / kMost));
    if (picture.samples[i] <= 64) {
      ++few;
      EXPECT_GT(color.b, color.r) << "blue: few";
    }
    if (picture.samples[i] == kMost) {
      ++most;
      EXPECT_GT(color.r, color.b) << "red: many";
    }
  }
  EXPECT_GT(few, 100u);
  EXPECT_GT(most, 10u);
  EXPECT_EQ(static_cast<double>(session.progress().samples_done), taken);
  EXPECT_EQ(session.progress().samples_total, session.progress().samples_done);
}

TEST_F(Adaptive, BatchesThatAreNoMultipleOfOursAreKept) {
  settings.adaptive = AdaptiveSampling{23, 0.1f};
  settings.samples_per_pixel = 100;
  const SampledPicture picture = sampled_picture(render(*scene, camera, settings));
  for (const float samples : picture.samples)
    EXPECT_TRUE(samples == 100 || static_cast<int>(samples) % 23 == 0) << samples;
}

}  // namespace
}  // namespace etendue
