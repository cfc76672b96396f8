#include "media/airlight.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "testing/quadrature.h"
#include "testing/random.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(WithinCone, KeepsThePointsThatAreInIt) {
  Random random(3);
  int met = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto vector = [&] { return Vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)); };
    const Point3 apex = vector();
    const Vec3 axis = normalize(vector());
    const float cos_angle = std::cos(random.between(0.05f, 2));
    const Ray ray{vector() * 2.0f, normalize(vector()), 0, random.value() < 0.5f ? kInfinity : 3.0f};
    const std::optional<Ray> inside = within_cone(ray, apex, axis, cos_angle);
    for (int j = 0; j < 20; ++j) {
      const float t = random.between(0, 3);
      const float margin = dot(normalize(ray.at(t) - apex), axis) - cos_angle;
      if (std::abs(margin) < 1e-3f) continue;
      const bool kept = inside && t >= inside->t_min && t <= inside->t_max;
      if (margin > 0) {
        ASSERT_TRUE(kept) << "case " << i;
        ++met;
      } else if (cos_angle >= 0) {
        ASSERT_FALSE(kept) << "case " << i;
      }
    }
  }
  EXPECT_GT(met, 4000);
}

TEST(WithinCone, TakesRaysThroughTheApexAndAlongTheAxis) {
  const Vec3 axis(0, 0, 1);
  const std::optional<Ray> from_apex = within_cone({{0, 0, 0}, axis}, {0, 0, 0}, axis, 0.9f);
  ASSERT_TRUE(from_apex);
  EXPECT_EQ(from_apex->t_min, 0);
  EXPECT_EQ(from_apex->t_max, kInfinity);
  const std::optional<Ray> through = within_cone({{0, 0, 3}, -axis}, {0, 0, 0}, axis, 0.9f);
  ASSERT_TRUE(through);
  EXPECT_NEAR(through->t_max, 3, 1e-5);
  EXPECT_FALSE(within_cone({{0, 0, -1}, -axis}, {0, 0, 0}, axis, 0.9f));
}

struct Case {
  std::string name;
  Spectrum sigma;
  float g;
  Ray ray;
  Point3 light;
  double deviation = 0.7;  ///< the most of a sample's estimate, relative to the mean
};

const Case kCases[] = {{"thin fog", Spectrum(0.05f), 0, {{0, 0, 0}, {0, 0, 1}, 0, 10}, {1, 0, 4}},
                       {"light near the ray", Spectrum(0.2f), 0.7f, {{0, 0, 0}, {0, 0, 1}, 0, 10}, {0.02f, 0, 6}},
                       {"away from the light, for ever", Spectrum(1), -0.5f, {{0, 0, 0}, {0, 0, 1}}, {0, 0.5f, -2}},
                       {"dense", Spectrum(40), 0.3f, {{0, 0, 0}, {0, 0, 1}, 1, 9}, {4, 0, 3}},
                       {"coloured", Spectrum(0.02f, 0.5f, 12), 0, {{0, 0, 0}, {0, 0, 1}, 0, 20}, {0, 2, 5}, 1.5}};

TEST(AirlightDistances, HaveTheDensityTheySay) {
  for (const Case& c : kCases) {
    const Medium medium(Volume(c.sigma), 1, Volume(Spectrum(1)), HenyeyGreensteinPhase{c.g});
    const AirlightDistances distances(medium, c.ray, SeenRay(c.ray, c.light), Spectrum(1));
    // What the density of angles adds up to over a hundredth of the samples is a hundredth.
    const SeenRay seen(c.ray, c.light);
    constexpr int kSamples = 20000, kBlock = kSamples / 100;
    double share = 0, last_angle = seen.begin, last_density = 0;
    for (int i = 0; i < kSamples; ++i) {
      const auto sample = distances.sample((static_cast<float>(i) + 0.5f) / kSamples);
      ASSERT_TRUE(sample) << c.name;
      ASSERT_GE(sample->t, c.ray.t_min) << c.name;
      ASSERT_LE(sample->t, c.ray.t_max) << c.name;
      const double offset = static_cast<double>(sample->t) - seen.nearest;
      const double angle = std::atan2(offset, seen.distance);
      const double density =
          static_cast<double>(sample->pdf) * (seen.distance * seen.distance + offset * offset) / seen.distance;
      if (i > 0) share += 0.5 * (density + last_density) * (angle - last_angle);
      last_angle = angle;
      last_density = density;
      if (i % kBlock != 0 || i == 0) continue;
      EXPECT_NEAR(share, 0.01, 2e-4) << c.name << ", before sample " << i;
      share = 0;
    }
  }
}

TEST(AirlightDistances, ResembleWhatIsScattered) {
  // The estimate of single scattering is right, and its deviation is small: more where colours differ much, for all
  // share the distance.
  for (const Case& c : kCases) {
    const Medium medium(Volume(c.sigma), 1, Volume(Spectrum(1)), HenyeyGreensteinPhase{c.g});
    const SeenRay seen(c.ray, c.light);
    const AirlightDistances distances(medium, c.ray, seen, Spectrum(1));
    const double at_start = length(c.light - c.ray.at(c.ray.t_min));
    const auto scattered = [&](double t) {
      const Vec3 to_light = c.light - c.ray.at(static_cast<float>(t));
      const double d = length(to_light);
      double sum = 0;
      for (int channel = 0; channel < 3; ++channel)
        sum += static_cast<double>(c.sigma[channel]) *
               std::exp(-static_cast<double>(c.sigma[channel]) * (t - c.ray.t_min + d - at_start));
      return sum * static_cast<double>(eval_phase(medium.phase(), -c.ray.direction, normalize(to_light))) / (d * d);
    };
    const double end = std::min(seen.end, 0.5 * std::numbers::pi - 1e-6);
    const double expected = integrate(
        [&](double angle) {
          const double cosine = std::cos(angle);
          return scattered(seen.nearest + seen.distance * std::tan(angle)) * seen.distance / (cosine * cosine);
        },
        seen.begin, end, 1e-7);
    RunningMean mean;
    Random random(5);
    for (int i = 0; i < 40000; ++i) {
      const auto sample = distances.sample(random.value());
      mean.add(sample ? scattered(static_cast<double>(sample->t)) / static_cast<double>(sample->pdf) : 0.0);
    }
    EXPECT_LT(mean.standard_error() * 200, c.deviation * expected) << c.name;
    EXPECT_GT(mean.p_value(expected, 1e-3 * expected), 1e-4) << c.name << ": " << mean.mean() << " of " << expected;
  }
}

}  // namespace
}  // namespace etendue
