#include "media/medium.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "testing/random.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

/// A grid of random values over the box from (−1, −1, −1) to (1, 2, 1), turned if asked for.
Volume noise(int size, int channels, float most, float angle, std::uint64_t seed) {
  Random random(seed);
  scene::GridVolume grid;
  grid.size = {size, size + 1, size + 2};
  grid.channels = channels;
  for (int i = 0; i < size * (size + 1) * (size + 2) * channels; ++i)
    grid.values.push_back(random.value() < 0.5f ? 0 : random.between(0, most));
  scene::Volume volume;
  volume.source = std::move(grid);
  volume.to_world =
      Transform::rotation({1, 2, 3}, angle) * Transform::translation({-1, -1, -1}) * Transform::scaling({2, 3, 2});
  return Volume(volume);
}

struct NamedMedium {
  std::string name;
  Medium medium;
};

std::vector<NamedMedium> media() {
  const Volume albedo(Spectrum(0.9f, 0.5f, 0.2f));
  return {{"grey", Medium(Volume(Spectrum(0.8f)), 1, albedo, IsotropicPhase{})},
          {"coloured", Medium(Volume(Spectrum(0.1f, 0.8f, 3)), 1.5f, albedo, IsotropicPhase{})},
          {"one channel empty", Medium(Volume(Spectrum(0, 0.8f, 3)), 1, albedo, IsotropicPhase{})},
          {"grid", Medium(noise(5, 1, 2, 0, 1), 1.5f, albedo, IsotropicPhase{})},
          {"coloured grid", Medium(noise(4, 3, 3, 0, 2), 1, noise(3, 3, 1, 0, 3), IsotropicPhase{})},
          {"turned grid", Medium(noise(20, 3, 4, 0.7f, 4), 1, albedo, IsotropicPhase{})}};
}

/// Through the grids' boxes, at an angle, along axes, and within.
const Ray kRays[] = {{{-3, 0.1f, 0.2f}, normalize(Vec3(1, 0.1f, -0.05f)), 0, 6},
                     {{0.3f, -4, 0.1f}, {0, 1, 0}, 1, 9},
                     {{0.3f, 0.4f, 0.1f}, normalize(Vec3(-1, 1, 1)), 0, 0.7f}};

/// What the flights along a ray have to give, by the midpoint rule.
struct Expected {
  Vec3d transmittance{1, 1, 1};
  Vec3d scattered{0, 0, 0};     ///< ∫ T σt a dt
  Vec3d scattered_at{0, 0, 0};  ///< ∫ t T σt a dt
};

Expected integrate_along(const Medium& medium, const Ray& ray) {
  constexpr int kSteps = 20000;
  Expected out;
  const double step = (static_cast<double>(ray.t_max) - ray.t_min) / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double t = ray.t_min + (i + 0.5) * step;
    const Point3 p = ray.at(static_cast<float>(t));
    const Spectrum extinction = medium.extinction(p), albedo = medium.albedo(p);
    for (int c = 0; c < 3; ++c) {
      const double passes = std::exp(-extinction[c] * step);
      const double scattered = out.transmittance[c] * (1 - passes) * albedo[c];
      out.scattered[c] += scattered;
      out.scattered_at[c] += t * scattered;
      out.transmittance[c] *= passes;
    }
  }
  return out;
}

struct Means {
  RunningMean value[3];
  void add(const Spectrum& s) {
    for (int c = 0; c < 3; ++c) value[c].add(s[c]);
  }
  void compare(TestFamily& tests, const std::string& what, const Vec3d& expected) const {
    for (int c = 0; c < 3; ++c) {
      EXPECT_LT(value[c].standard_error(), 0.02 * expected[c] + 1e-3) << what;
      tests.add(fmt::format("{}, channel {}: {} instead of {}", what, c, value[c].mean(), expected[c]),
                value[c].p_value(expected[c], 3e-4 * expected[c] + 1e-6));
    }
  }
};

TEST(Medium, FlightsFollowTheExtinction) {
  TestFamily tests;
  for (const auto& [name, medium] : media())
    for (const Ray& ray : kRays)
      for (const Spectrum& throughput : {Spectrum(1), Spectrum(0.5f, 1, 2)}) {
        const Expected expected = integrate_along(medium, ray);
        Random random(5);
        RandomStream stream(random.point());
        Means passed, scattered, scattered_at;
        for (int i = 0; i < 100000; ++i) {
          const Flight flight = sample_flight(medium, ray, throughput, random.point(), stream);
          passed.add(flight.t ? Spectrum(0) : flight.weight);
          scattered.add(flight.t ? flight.weight : Spectrum(0));
          scattered_at.add(flight.t ? flight.weight * *flight.t : Spectrum(0));
          // No more than all channels had before.
          const Spectrum after = throughput * flight.weight;
          ASSERT_LE(after.r + after.g + after.b, (throughput.r + throughput.g + throughput.b) * 1.001f) << name;
        }
        const std::string what =
            fmt::format("{} along ({}, {}, {})", name, ray.direction.x, ray.direction.y, ray.direction.z);
        passed.compare(tests, what + " passed", expected.transmittance);
        scattered.compare(tests, what + " scattered", expected.scattered);
        scattered_at.compare(tests, what + " scattered at", expected.scattered_at);
      }
  EXPECT_TRUE(tests.holds());
}

TEST(Medium, TransmittanceIsBeersLaw) {
  TestFamily tests;
  for (const auto& [name, medium] : media())
    for (const Ray& ray : kRays) {
      const Expected expected = integrate_along(medium, ray);
      RandomStream stream({0.3f, 0.6f});
      Means share;
      for (int i = 0; i < 30000; ++i) share.add(transmittance(medium, ray, Spectrum(1), stream).share);
      share.compare(tests, name, expected.transmittance);
      if (!medium.is_homogeneous()) continue;
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(transmittance(medium, ray, Spectrum(1), stream).share[c], expected.transmittance[c],
                    1e-4 * expected.transmittance[c]);
    }
  EXPECT_TRUE(tests.holds());
}

TEST(Medium, SurvivalIsTheProbabilityOfNotBeingScattered) {
  TestFamily tests;
  const Spectrum throughput(0.2f, 1, 3);
  for (const auto& [name, medium] : media()) {
    if (!medium.is_homogeneous()) continue;
    Random random(6);
    RandomStream stream(random.point());
    const double survival = transmittance(medium, kRays[0], throughput, stream).survival;
    RunningMean passed;
    for (int i = 0; i < 100000; ++i) {
      const Flight flight = sample_flight(medium, kRays[0], throughput, random.point(), stream);
      passed.add(flight.t ? 0 : 1);
      if (!flight.t) {
        ASSERT_FLOAT_EQ(flight.survival, static_cast<float>(survival));
      }
    }
    tests.add(name, passed.p_value(survival));
  }
  EXPECT_TRUE(tests.holds());
}

TEST(Medium, NothingHappensInNothing) {
  const Medium nothing(Volume(Spectrum(0)), 1, Volume(Spectrum(0.5f)), IsotropicPhase{});
  const Ray ray{{0, 0, 0}, {0, 0, 1}};
  RandomStream stream({0.5f, 0.5f});
  EXPECT_FALSE(sample_flight(nothing, ray, Spectrum(1), {0.5f, 0.99f}, stream).t);
  EXPECT_EQ(transmittance(nothing, ray, Spectrum(1), stream).share, Spectrum(1));
}

TEST(Medium, RaysThatMissAGridPassIt) {
  const Medium medium(noise(5, 1, 2, 0, 1), 1, Volume(Spectrum(1)), IsotropicPhase{});
  for (const Ray& ray :
       {Ray{{0, 5, 0}, {1, 0, 0}}, Ray{{-5, 0, 0}, {-1, 0, 0}}, Ray{{0, 0, 5}, normalize(Vec3(1, 1, -0.1f))}}) {
    RandomStream stream({0.5f, 0.5f});
    EXPECT_FALSE(sample_flight(medium, ray, Spectrum(1), {0.5f, 0.5f}, stream).t);
    EXPECT_EQ(transmittance(medium, ray, Spectrum(1), stream).share, Spectrum(1));
  }
}

TEST(Medium, ValuesThatNoMediumHasAreBroughtToWhatIsNear) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  const Medium constant(Volume(Spectrum(nan, -1, infinite)), 1, Volume(Spectrum(nan, -1, 2)), IsotropicPhase{});
  EXPECT_EQ(constant.extinction({0, 0, 0}), Spectrum(0, 0, constant.max_extinction()));
  EXPECT_EQ(constant.albedo({0, 0, 0}), Spectrum(0, 0, 1));
  const Medium dense(noise(5, 1, 1e20f, 0, 1), 1, Volume(Spectrum(1)), IsotropicPhase{});
  RandomStream stream({0.5f, 0.5f});
  EXPECT_TRUE(sample_flight(dense, kRays[0], Spectrum(1), {0.5f, 0.5f}, stream).t);
  EXPECT_EQ(transmittance(dense, kRays[0], Spectrum(1), stream).share, Spectrum(0));
}

}  // namespace
}  // namespace etendue
