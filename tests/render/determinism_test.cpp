// The same seed gives the same picture, to the bit, however the work is cut.

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "base/parallel.h"
#include "camera/placement.h"
#include "formats/formats.h"
#include "picture_statistics.h"
#include "render/session.h"
#include "scene_kit.h"
#include "testing/random.h"

namespace etendue {
namespace {

/// The Cornell box with spheres, through a lens: every kind of random decision.
struct Variant {
  std::string name;
  SamplerKind sampler;
  std::optional<AdaptiveSampling> adaptive;
};

std::ostream& operator<<(std::ostream& out, const Variant& variant) {
  return out << variant.name;
}

class Determinism : public ::testing::TestWithParam<Variant> {
 protected:
  Determinism() {
    settings.width = 44;
    settings.height = 34;
    settings.samples_per_pixel = 64;
    settings.sampler = GetParam().sampler;
    settings.adaptive = GetParam().adaptive;
    settings.seed = 0x123456789abcdefull;
    Diagnostics diagnostics;
    const scene::SceneDescription description = read_scene(SCENES_FOLDER "/cornell-spheres.dae", diagnostics);
    scene = std::make_unique<RenderScene>(compile(description, {}, diagnostics));
    camera = place_camera(description, scene->bounds(), CameraPlacement::automatic, settings.width, settings.height,
                          diagnostics);
    camera.lens_radius = 0.05f;
    camera.focal_distance = 5;
  }

  Picture in_passes(const RenderSettings& chosen, const std::vector<int>& passes) const {
    RenderSession session(*scene, camera, chosen);
    for (const int samples : passes) session.render_pass({}, samples);
    EXPECT_TRUE(session.finished());
    return session.snapshot();
  }
  Picture in_one_pass(const RenderSettings& chosen) const { return in_passes(chosen, {chosen.samples_per_pixel}); }

  RenderSettings settings;
  std::unique_ptr<RenderScene> scene;
  Camera camera;
};

TEST_P(Determinism, ForAnyNumberOfThreads) {
  Picture first;
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    const Picture picture = in_one_pass(settings);
    if (first.beauty.empty()) first = picture;
    EXPECT_TRUE(identical(picture, first)) << threads << " threads";
  }
}

TEST_P(Determinism, ForAnyTileSize) {
  const Picture expected = in_one_pass(settings);
  for (const int tile_size : {1, 5, 64}) {
    RenderSettings tiled = settings;
    tiled.tile_size = tile_size;
    EXPECT_TRUE(identical(in_one_pass(tiled), expected)) << "tiles of " << tile_size;
  }
}

TEST_P(Determinism, ForAnySplitIntoPasses) {
  const Picture expected = in_one_pass(settings);
  EXPECT_TRUE(identical(in_passes(settings, {16, 48}), expected));
  EXPECT_TRUE(identical(in_passes(settings, {16, 16, 16, 16}), expected));
  EXPECT_TRUE(identical(in_passes(settings, {1, 17, 64}), expected));
}

TEST_P(Determinism, WhenStoppedAndResumed) {
  const Picture expected = in_one_pass(settings);
  Random random(3);
  for (int run = 0; run < 3; ++run) {
    RenderSession session(*scene, camera, settings);
    int passes = 0;
    for (; !session.finished(); ++passes) {
      std::stop_source source;
      const std::chrono::microseconds wait(static_cast<int>(random.between(0, 8000)));
      std::jthread stopper([&] {
        std::this_thread::sleep_for(wait);
        source.request_stop();
      });
      session.render_pass(source.get_token(), 16);
    }
    EXPECT_TRUE(identical(session.snapshot(), expected)) << "after " << passes << " passes";
  }
}

TEST_P(Determinism, AStoppedPassLeavesAValidPicture) {
  RenderSession session(*scene, camera, settings);
  std::stop_source source;
  source.request_stop();
  session.render_pass(source.get_token(), 64);
  EXPECT_FALSE(session.finished());
  EXPECT_EQ(session.progress().samples_done, 0u);
  const Image image = session.beauty();
  for (const Spectrum& s : image.pixels()) EXPECT_EQ(s, Spectrum(0));
}

TEST_P(Determinism, OtherSeedsGiveOtherPictures) {
  const Picture expected = in_one_pass(settings);
  for (const std::uint64_t difference : {std::uint64_t{1}, std::uint64_t{1} << 40}) {
    RenderSettings other = settings;
    other.seed ^= difference;
    EXPECT_FALSE(identical(in_one_pass(other), expected)) << difference;
  }
}

/// Photons and the cache are made anew on the way; passes may end in the middle of what one set serves. What counts for
/// less than it would is chosen when the picture is asked for.
TEST_P(Determinism, ThroughSeveralGenerations) {
  RenderSettings large = settings;
  large.width = large.height = 128;
  large.crop = CropWindow{40, 50, 24, 20};
  large.samples_per_pixel = 48;
  large.photons = large.reuse = large.cache = large.splitting = Use::on;
  large.doubts_outliers = true;
  Picture expected;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const Picture picture = in_one_pass(large);
    if (expected.beauty.empty()) expected = picture;
    EXPECT_TRUE(identical(picture, expected)) << threads << " threads";
    EXPECT_TRUE(identical(in_passes(large, {1, 19, 48}), expected));
  }
}

INSTANTIATE_TEST_SUITE_P(
    , Determinism,
    ::testing::Values(Variant{"Sobol", SamplerKind::sobol, {}}, Variant{"Independent", SamplerKind::independent, {}},
                      Variant{"SobolAdaptive", SamplerKind::sobol, AdaptiveSampling{16, 0.4f}},
                      Variant{"IndependentAdaptive", SamplerKind::independent, AdaptiveSampling{16, 0.4f}}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace etendue
