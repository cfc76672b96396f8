// Photons and what is recorded for lookups take no more memory than they may, and show the same light with little.

#include <gtest/gtest.h>

#include "allocation_counter.h"
#include "base/error.h"
#include "render/session.h"
#include "technique_comparison.h"

namespace etendue {
namespace {

/// A wide lamp in a room of diffuse walls with a ball of glass and one of a mirror.
Place room_with_glass() {
  Place place;
  SceneKit& kit = place.kit;
  room(kit, {-1, 0, -1}, {1, 2, 1}, kit.diffuse({0.5f, 0.4f, 0.3f}));
  kit.sphere({0.3f, 0.6f, 0}, 0.4f, glass(kit));
  kit.sphere({-0.6f, 0.5f, -0.3f}, 0.3f, mirror(kit));
  kit.quad({-0.9f, 1.98f, -0.9f}, {1.8f, 0, 0}, {0, 0, 1.8f}, kit.emitter(Spectrum(1)));
  place.camera = pinhole({0, 1, 0.95f}, {0, 0.5f, 0}, 0.8f);
  return place;
}

/// The most that two generations of a picture that wants many photons and records take, by the part that is rendered.
std::int64_t memory_taken(const RenderScene& scene, const Camera& camera, RenderSettings settings) {
  settings.width = settings.height = 2048;
  settings.crop = CropWindow{1020, 1020, 8, 8};
  settings.samples_per_pixel = 32;
  const std::int64_t before = bytes_held();
  forget_most_bytes_held();
  RenderSession session(scene, camera, settings);
  session.render_pass({}, 32);
  return most_bytes_held() - before;
}

TEST(MemoryLimit, IsKept) {
  constexpr std::int64_t kRest = 300'000;  // film, paths under way, threads
  const Place place = room_with_glass();
  const RenderScene scene = place.kit.compile();
  for (const std::int64_t limit : {1 << 20, 1 << 25})
    for (const bool halves : {false, true}) {
      RenderSettings settings;
      settings.photons = settings.cache = Use::on;
      settings.for_denoising = halves;
      settings.memory_limit = static_cast<std::uint64_t>(limit);
      const std::int64_t taken = memory_taken(scene, place.camera, settings);
      EXPECT_LE(taken, limit + kRest) << limit << (halves ? ", two halves" : "");
      EXPECT_GE(taken, limit / 4) << limit << (halves ? ", two halves" : "");
    }
}

TEST(MemoryLimit, IsLargeEnough) {
  const RenderScene scene = room_with_glass().kit.compile();
  RenderSettings settings;
  settings.memory_limit = kLeastMemory - 1;
  EXPECT_THROW(RenderSession(scene, room_with_glass().camera, settings), Error);
}

TEST(MemoryLimit, LittleMemoryShowsTheSameLight) {
  const Technique little{.name = "little memory", .photons = Use::on, .cache = Use::on, .memory_limit = kLeastMemory};
  Look look;
  look.whole_side = 256;
  look.side = 48;
  look.plain_samples = 128;
  look.samples = 48;
  look.blur = 0.01;
  expect_same_means(room_with_glass(), std::span(&little, 1), look);
}

}  // namespace
}  // namespace etendue
