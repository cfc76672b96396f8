// What sensors other than cameras with a lens measure, against closed forms.

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "render/session.h"
#include "scene_kit.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

/// The mean of a picture whose every pixel measures the irradiance of the scene's first instance.
RunningMean measured(scene::SceneDescription description) {
  scene::Camera meter;
  meter.projection = scene::Projection::irradiance;
  meter.measured_shape = 0;
  description.cameras = {meter};
  Diagnostics diagnostics;
  Camera camera;
  camera.projection = Projection::irradiance;
  RenderSettings settings;
  settings.width = settings.height = 16;
  settings.samples_per_pixel = 128;
  RenderSession session(compile(description, {}, diagnostics), camera, settings);
  while (!session.finished()) session.render_pass({});
  RunningMean mean;
  const Image picture = session.beauty();
  for (const Spectrum& pixel : picture.pixels()) mean.add(pixel.g);
  return mean;
}

TEST(IrradianceMeter, SeesPiOfAUniformSky) {
  SceneKit quad;  // its front is up
  quad.quad({0, 0, 0}, {0, 0, 2}, {3, 0, 0}, quad.diffuse(Spectrum(0.5f)));
  quad.light(scene::HemisphereLight{Spectrum(2)});
  const RunningMean up = measured(quad.description());
  EXPECT_NEAR(up.mean(), 2 * kPi, 1e-4);

  SceneKit ball;
  ball.sphere({1, 2, 3}, 0.5f, ball.diffuse(Spectrum(0.5f)));
  ball.light(scene::ConstantLight{Spectrum(2)});
  EXPECT_NEAR(measured(ball.description()).mean(), 2 * kPi, 1e-4);
}

TEST(IrradianceMeter, WeighsADiskByItsArea) {
  // A squashed disk below the middle of a square lamp of twice half its height's size: four times the closed form for a
  // corner, E = L/2 · 2 A / √(1 + A²) · atan(A / √(1 + A²)), A = half side / height (Howell's catalogue, B-4).
  const double ratio = 0.5, root = std::sqrt(1 + ratio * ratio);
  const double expected = 4 * 100 * ratio / root * std::atan(ratio / root);
  SceneKit kit;
  const MaterialId grey = kit.diffuse(Spectrum(0.5f));
  kit.quad({-5, 10, -5}, {10, 0, 0}, {0, 0, 10}, kit.emitter(Spectrum(100)));  // its front is down
  scene::SceneDescription description = kit.description();
  description.disks.push_back({});
  scene::Instance disk = description.instances[0];
  disk.shape = scene::Id<scene::Disk>{0};
  disk.material = grey;
  disk.to_world = {{0.2f, 0, 0}, {0, 0, -0.05f}, {0, 1, 0}, {0, 0, 0}};  // faces up
  description.instances.insert(description.instances.begin(), disk);
  const RunningMean mean = measured(description);
  EXPECT_LT(mean.standard_error(), 0.005 * expected);
  EXPECT_NEAR(mean.mean(), expected, 4 * mean.standard_error() + 1e-3 * expected);
}

TEST(IrradianceMeter, NeedsASurface) {
  SceneKit kit;
  kit.sphere({0, 0, 0}, 1, kit.diffuse(Spectrum(0.5f)));
  scene::SceneDescription description = kit.description();
  scene::Camera meter;
  meter.projection = scene::Projection::irradiance;
  description.cameras = {meter};
  Diagnostics diagnostics;
  EXPECT_THROW(compile(description, {}, diagnostics), Error);
}

}  // namespace
}  // namespace etendue
