// Renders made for denoising: their halves, and what becomes of their noise.

#include "denoise/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "camera/placement.h"
#include "formats/formats.h"
#include "image/compare.h"
#include "render/session.h"

namespace etendue {
namespace {

/// The Cornell box with a mirror and a glass sphere.
class DenoiseRender : public ::testing::Test {
 protected:
  DenoiseRender() {
    Diagnostics diagnostics;
    const scene::SceneDescription description = read_scene(SCENES_FOLDER "/cornell-spheres.dae", diagnostics);
    scene = std::make_unique<RenderScene>(compile(description, {}, diagnostics));
    settings.width = 64;
    settings.height = 48;
    settings.for_denoising = true;
    camera =
        place_camera(description, scene->bounds(), CameraPlacement::file, settings.width, settings.height, diagnostics);
  }

  /// In passes of so many samples.
  RenderSession render(int samples, int pass) const {
    RenderSettings chosen = settings;
    chosen.samples_per_pixel = samples;
    RenderSession session(*scene, camera, chosen);
    while (!session.finished()) session.render_pass({}, pass);
    return session;
  }

  RenderSettings settings;
  std::unique_ptr<RenderScene> scene;
  Camera camera;
};

bool equal(const Image& a, const Image& b) {
  return std::ranges::equal(a.pixels(), b.pixels());
}

TEST_F(DenoiseRender, IsNearerToTheTruthThanTheNoisyPicture) {
  settings.seed = 1;
  settings.for_denoising = false;
  const Image truth = render(1024, 1024).beauty();
  settings.seed = 0;
  settings.for_denoising = true;
  const auto gain = [&](int samples) {
    const RenderSession session = render(samples, samples);
    const double before = measure_error(session.beauty(), truth).relative_mse;
    return before / measure_error(denoise_by_regression(session.noisy_picture().value()).image, truth).relative_mse;
  };
  EXPECT_GT(gain(8), 2.5);
  EXPECT_GT(gain(32), 1.4);
  EXPECT_GT(gain(128), 1.15);
  settings.integrator = IntegratorKind::path;  // leaves more to do
  EXPECT_GT(gain(8), 5);
  EXPECT_GT(gain(32), 2.5);
  EXPECT_GT(gain(128), 1.8);
}

TEST_F(DenoiseRender, HasTheSameHalvesHoweverItIsCut) {
  const auto whole = render(37, 37).noisy_picture(), cut = render(37, 3).noisy_picture();
  ASSERT_TRUE(whole && cut);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(equal(whole->halves[i].color, cut->halves[i].color));
    EXPECT_TRUE(equal(whole->halves[i].variance, cut->halves[i].variance));
    EXPECT_TRUE(equal(whole->halves[i].normal, cut->halves[i].normal));
  }
  EXPECT_FALSE(equal(whole->halves[0].color, whole->halves[1].color));
}

TEST_F(DenoiseRender, ShowsTheMeanOfItsHalves) {
  const RenderSession session = render(32, 32);
  const auto noisy = session.noisy_picture();
  ASSERT_TRUE(noisy);
  Image mean = noisy->halves[0].color;
  for (std::size_t i = 0; i < mean.pixels().size(); ++i)
    mean.pixels()[i] = (mean.pixels()[i] + noisy->halves[1].color.pixels()[i]) * 0.5f;
  EXPECT_LT(measure_error(mean, session.beauty()).relative_mse, 1e-12);
}

/// Were they not, their difference would say too little or too much of the noise.
TEST_F(DenoiseRender, HasIndependentHalves) {
  settings.width = 256;
  settings.height = 192;
  settings.sampler = SamplerKind::independent;
  settings.integrator = IntegratorKind::ao;  // no heavy tails
  const auto noisy = render(64, 64).noisy_picture();
  ASSERT_TRUE(noisy);
  const auto& [a, b] = noisy->halves;
  double seen = 0, expected = 0;
  for (std::size_t i = 0; i < a.color.pixels().size(); ++i) {
    const float difference = a.color.pixels()[i].g - b.color.pixels()[i].g;
    seen += difference * difference;
    expected += a.variance.pixels()[i].g + b.variance.pixels()[i].g;
  }
  ASSERT_GT(expected, 0);
  EXPECT_NEAR(seen / expected, 1, 0.03);
}

TEST_F(DenoiseRender, NeedsFourSamplesAndToBeAskedFor) {
  EXPECT_FALSE(render(3, 3).noisy_picture());
  EXPECT_TRUE(render(4, 4).noisy_picture());
  settings.for_denoising = false;
  EXPECT_FALSE(render(4, 4).noisy_picture());
}

}  // namespace
}  // namespace etendue
