#include "technique_comparison.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "testing/statistics.h"

namespace etendue {
namespace {

/// Means over the quarters of a picture and over all of it (the fifth), of several seeds.
struct SeedMeans {
  RunningMean part[5][3];
};

SeedMeans means_of(const Place& place, const RenderScene& scene, RenderSettings settings, int seeds) {
  SeedMeans means;
  for (int seed = 1; seed <= seeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const Image image = render(scene, place.camera, settings).beauty;
    const int half = image.width() / 2;
    Spectrum sums[5];
    for (int q = 0; q < 4; ++q) {
      Spectrum sum;
      for (int y = 0; y < half; ++y)
        for (int x = 0; x < half; ++x) sum += image.at(x + q % 2 * half, y + q / 2 * half);
      sums[q] = sum * (1 / static_cast<float>(half * half));
      sums[4] += sums[q] * 0.25f;
    }
    for (int q = 0; q < 5; ++q)
      for (int c = 0; c < 3; ++c) means.part[q][c].add(sums[q][c]);
  }
  return means;
}

void compare(const SeedMeans& plain, const SeedMeans& other, const Look& look) {
  TestFamily tests;
  for (int q = 0; q < 5; ++q)
    for (int c = 0; c < 3; ++c) {
      const RunningMean &a = plain.part[q][c], &b = other.part[q][c];
      const double error = std::hypot(a.standard_error(), b.standard_error());
      EXPECT_LT(error / a.mean(), q == 4 ? 0.004 : look.quarter_error) << "part " << q;
      const double difference = std::max(0.0, std::abs(a.mean() - b.mean()) - look.blur * a.mean());
      tests.add(fmt::format("part {}, channel {}: {} and {} ± {}", q, c, a.mean(), b.mean(), error),
                normal_p(difference / error));
    }
  EXPECT_TRUE(tests.holds());
}

}  // namespace

RenderSettings with(const Technique& technique, RenderSettings settings) {
  settings.integrator = technique.integrator;
  settings.photons = technique.photons;
  settings.reuse = technique.reuse;
  settings.cache = technique.cache;
  settings.sampler = technique.sampler;
  settings.splitting = technique.splitting;
  settings.memory_limit = technique.memory_limit;
  settings.airlight = technique.airlight;
  return settings;
}

Look small_look(int samples, int depth) {
  return {.whole_side = 64, .side = 64, .depth = depth, .plain_samples = 128, .samples = samples};
}

MaterialId glass(SceneKit& kit) {
  return kit.material(scene::GlassMaterial{Spectrum(1), {0.9f, 1, 0.8f}, 1.5f});
}

MaterialId mirror(SceneKit& kit) {
  return kit.material(scene::MirrorMaterial{{0.9f, 0.8f, 0.7f}});
}

MaterialId steel(SceneKit& kit, float alpha) {
  scene::ConductorMaterial steel;
  steel.eta = Spectrum(2.9f, 2.8f, 2.5f);
  steel.k = Spectrum(3.1f, 2.9f, 2.7f);
  steel.alpha_u = steel.alpha_v = alpha;
  return kit.material(steel);
}

void room(SceneKit& kit, const Point3& low, const Point3& high, MaterialId material) {
  const Vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  kit.quad(low, z, x, material);
  kit.quad(low, x, y, material);
  kit.quad(low, y, z, material);
  kit.quad(high, -x, -z, material);
  kit.quad(high, -y, -x, material);
  kit.quad(high, -z, -y, material);
}

void expect_same_means(const Place& place, std::span<const Technique> techniques, const Look& look) {
  const RenderScene scene = place.kit.compile();
  RenderSettings settings;
  settings.width = settings.height = look.whole_side;
  const int border = (look.whole_side - look.side) / 2;
  settings.crop = CropWindow{border, border, look.side, look.side};
  settings.max_depth = look.depth;
  settings.integrator = IntegratorKind::path;
  settings.samples_per_pixel = look.plain_samples;
  const SeedMeans plain = means_of(place, scene, settings, look.seeds);
  settings.samples_per_pixel = look.samples;
  for (const Technique& technique : techniques) {
    SCOPED_TRACE(technique.name);
    compare(plain, means_of(place, scene, with(technique, settings), look.seeds), look);
  }
}

}  // namespace etendue
