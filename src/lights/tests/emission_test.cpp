#include "lights/emission.h"

#include <gtest/gtest.h>

#include <cmath>

#include "light_kit.h"
#include "sampling/warp.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

constexpr int kCount = 400'000;

const std::vector<AimTarget> kBalls{{{0.5f, -1.5f, 0.2f}, 0.4f}, {{0.7f, -1.6f, 0.3f}, 0.3f}, {{-2, 0.3f, 0}, 0.2f}};

bool meets(const Ray& ray, const AimTarget& ball) {
  const Vec3 d = ball.center - ray.origin;
  return dot(d, ray.direction) > 0 && length_squared(cross(d, ray.direction)) < square(ball.radius);
}
bool meets_any(const Ray& ray) {
  return std::ranges::any_of(kBalls, [&](const AimTarget& ball) { return meets(ray, ball); });
}

/// Flux into the balls, by aimed rays.
RunningMean aimed_flux(const std::vector<Light>& lights) {
  const LightAim aim(lights, kBalls, kScene);
  EXPECT_TRUE(aim.possible());
  Random random(3);
  RunningMean mean;
  for (int i = 0; i < kCount; ++i) {
    const Vec2 which = random.point(), position = random.point(), direction = random.point();
    const auto ray = aim.sample(which, position, direction, random.value());
    mean.add(ray && meets_any(ray->ray) ? ray->radiance.g / ray->density : 0.0f);
  }
  return mean;
}

/// The same by rays that leave the light's surface by the cosine, whatever they meet.
RunningMean unaimed_flux(const std::vector<Light>& lights) {
  Random random(4);
  RunningMean mean;
  for (int i = 0; i < 30 * kCount; ++i) {
    double flux = 0;
    for (const Light& light : lights) {
      const Vec2 position = random.point(), direction = random.point();
      const auto point = sample_light_point(light, position, random.value());
      const Vec3 w = Frame::from_normal(point->surface.geometric_normal).to_world(sample_hemisphere_cosine(direction));
      if (meets_any({point->surface.position, w})) flux += point->radiance.g * kPi / point->pdf_area;
    }
    mean.add(flux);
  }
  return mean;
}

void expect_equal(const RunningMean& a, const RunningMean& b) {
  const double error = std::hypot(a.standard_error(), b.standard_error());
  EXPECT_LT(error, 0.004 * b.mean()) << "too noisy to see an error of 1 %";
  EXPECT_GT(normal_p((a.mean() - b.mean()) / error), 0.001) << a.mean() << " and " << b.mean() << " ± " << error;
}

const RectangleLight kPanel{Rectangle({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}), Spectrum(2)};
const SphereLight kBulb{{0, 0.5f, 0}, 0.3f, Spectrum(3)};

TEST(LightAim, AimedFluxIsTheFlux) {
  for (const std::vector<Light>& lights :
       {std::vector<Light>{kPanel}, {kBulb}, {MeshLight(cube(), Spectrum(1))}, {kPanel, kBulb}})
    expect_equal(aimed_flux(lights), unaimed_flux(lights));
}

TEST(LightAim, ASkyShinesOnABallFromAllSides) {
  const std::vector<Light> sky{UniformLight{Spectrum(2)}};
  const std::vector<AimTarget> ball{{{0.2f, 0.3f, 0}, 0.5f}};
  const LightAim aim(sky, ball, kScene);
  Random random(3);
  RunningMean flux;
  for (int i = 0; i < kCount; ++i) {
    const auto ray = aim.sample(random.point(), random.point(), random.point(), random.value());
    ASSERT_TRUE(ray);
    EXPECT_TRUE(meets(ray->ray, {ball[0].center, 1.001f * ball[0].radius}));
    flux.add(ray->radiance.g / ray->density);
  }
  EXPECT_NEAR(flux.mean(), 2 * 4 * kPi * kPi * square(0.5f), 1e-3 * flux.mean());  // L · 4π · πr²
}

TEST(LightAim, FoundRaysHaveTheDensityOfTheirSampling) {
  const std::vector<Light> lights{kPanel, kBulb, UniformLight{Spectrum(0.5f)}};
  const LightAim aim(lights, kBalls, kScene);
  Random random(5);
  int finite = 0, infinite = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec2 which = random.point(), position = random.point(), direction = random.point();
    const auto ray = aim.sample(which, position, direction, random.value());
    if (!ray) continue;
    const Vec3 w = ray->ray.direction;
    if (ray->radiance.g == 0.5f) {
      ++infinite;
      EXPECT_NEAR(aim.density_from_infinity(2, ray->ray.at(1), -w, sphere_uniform_pdf()) / ray->density, 1, 1e-3);
    } else {
      ++finite;
      const bool panel = ray->radiance.g == 2;
      const Point3 p = ray->ray.origin;
      const Vec3 normal = panel ? kPanel.rectangle.normal : normalize(p - kBulb.center);
      EXPECT_NEAR(aim.density(panel ? 0 : 1, {p, normal}, w) / ray->density, 1, 1e-3);
    }
  }
  EXPECT_GT(finite, 100);
  EXPECT_GT(infinite, 100);
}

TEST(LightAim, LightsThatNoBsdfFindsSendNothing) {
  const std::vector<Light> lights{PointLight{{0, 1, 0}, Spectrum(1)}};
  EXPECT_FALSE(LightAim(lights, kBalls, kScene).possible());
  EXPECT_FALSE(LightAim({}, kBalls, kScene).possible());
}

TEST(LightAim, NothingToAimAtIsNothingToSend) {
  EXPECT_FALSE(LightAim({kPanel}, {}, kScene).possible());
}

}  // namespace
}  // namespace etendue
