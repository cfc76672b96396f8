#include "media/phase.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "testing/random.h"
#include "testing/sphere_grid.h"

namespace etendue {
namespace {

struct NamedPhase {
  const char* name;
  Phase phase;
  double mean_cosine;
};

const NamedPhase kPhases[] = {{"isotropic", IsotropicPhase{}, 0},
                              {"g = 0", HenyeyGreensteinPhase{0}, 0},
                              {"g = 0.001", HenyeyGreensteinPhase{0.001f}, 0.001},
                              {"g = 0.5", HenyeyGreensteinPhase{0.5f}, 0.5},
                              {"g = -0.7", HenyeyGreensteinPhase{-0.7f}, -0.7},
                              {"g = 0.95", HenyeyGreensteinPhase{0.95f}, 0.95}};

const Vec3 kDirections[] = {{0, 0, 1}, {0, 0, -1}, normalize(Vec3(1, -2, 0.5f))};

TEST(Phase, IntegratesToOneAndHasItsMeanCosine) {
  for (const auto& [name, phase, mean_cosine] : kPhases)
    for (const Vec3& wo : kDirections) {
      const SphereGrid grid(-wo, 0.2);
      const auto value = [&](const Vec3& wi) { return static_cast<double>(eval_phase(phase, wo, wi)); };
      EXPECT_NEAR(integrate_sphere(grid, value), 1, 1e-4) << name;
      EXPECT_NEAR(integrate_sphere(grid, [&](const Vec3& wi) { return value(wi) * -dot(wo, wi); }), mean_cosine, 1e-4)
          << name;
    }
}

TEST(Phase, SamplesFollowTheirDensity) {
  TestFamily tests;
  Random random(1);
  for (const auto& [name, phase, mean_cosine] : kPhases)
    for (const Vec3& wo : kDirections) {
      const SphereGrid grid(-wo, 1 - std::abs(mean_cosine));
      const auto sample = [&]() -> std::optional<Vec3> {
        const PhaseSample s = sample_phase(phase, wo, random.point());
        EXPECT_NEAR(length(s.wi), 1, 1e-5f);
        EXPECT_NEAR(s.pdf, eval_phase(phase, wo, s.wi), 1e-2f * s.pdf) << name;
        return s.wi;
      };
      const auto density = [&](const Vec3& wi) { return static_cast<double>(eval_phase(phase, wo, wi)); };
      tests.add(fmt::format("{} from ({} {} {})", name, wo.x, wo.y, wo.z),
                direction_test(grid, 100000, sample, density).p);
    }
  EXPECT_TRUE(tests.holds());
}

TEST(Phase, PositiveMeanCosineSendsLightOn) {
  const Vec3 wo(0, 0, 1);
  EXPECT_GT(eval_phase(HenyeyGreensteinPhase{0.5f}, wo, -wo), 10 * eval_phase(HenyeyGreensteinPhase{0.5f}, wo, wo));
}

}  // namespace
}  // namespace etendue
