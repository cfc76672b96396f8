// Scenes whose radiance is known because light comes from everywhere.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <complex>

#include "base/tests/temporary_folder.h"
#include "picture_statistics.h"
#include "scene_kit.h"
#include "testing/quadrature.h"

namespace etendue {
namespace {

/// A scene in an environment of radiance 1.
class WhiteFurnace : public ::testing::Test {
 protected:
  WhiteFurnace() { kit.light(environment_map(folder / "white.exr", Image(4, 3, Spectrum(1)))); }

  TemporaryFolder folder;
  SceneKit kit;
};

const Camera kAtUnitSphere = pinhole({0, 0.5f, 4}, {0, 0, 0}, 0.18f);  // sees nothing but the sphere
const Camera kAroundUnitSphere = pinhole({0, 0.5f, 4}, {0, 0, 0}, 0.3f);

TEST_F(WhiteFurnace, DiffuseSphereShowsItsAlbedo) {
  const Spectrum albedo(0.2f, 0.5f, 0.9f);
  kit.sphere({0, 0, 0}, 1, kit.diffuse(albedo));
  TestFamily tests;
  for (const EnvironmentSampling sampling : {EnvironmentSampling::uniform, EnvironmentSampling::importance}) {
    const RenderScene scene = kit.compile({.fresnel = {}, .environment_sampling = sampling});
    for (const int light_samples : {0, 4})
      for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::hemisphere}) {
        RenderSettings settings = square_settings(24, 64);
        settings.light_samples = light_samples;
        settings.integrator = kind;
        const Picture picture = render(scene, kAtUnitSphere, settings);
        for (int c = 0; c < 3; ++c) {
          const RunningMean mean = over_pixels(picture.beauty, c);
          EXPECT_LT(mean.standard_error(), 0.004 * albedo[c]);
          tests.add(fmt::format("importance {}, {} light samples, integrator {}, channel {}",
                                sampling == EnvironmentSampling::importance, light_samples, static_cast<int>(kind), c),
                    mean.p_value(albedo[c], 1e-5));
        }
      }
  }
  EXPECT_TRUE(tests.holds());
}

/// Every sample is worth `expected`, but for rounding.
void expect_exactly(const Picture& picture, const Spectrum& expected) {
  const SampledPicture sampled = sampled_picture(picture);
  for (std::size_t i = 0; i < sampled.samples.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      ASSERT_NEAR(sampled.mean.pixels()[i][c], expected[c], 2e-6) << "pixel " << i;
      ASSERT_LT(sampled.variance.pixels()[i][c], 1e-10) << "pixel " << i;
    }
}

TEST_F(WhiteFurnace, MirrorShowsItsReflectanceWithoutNoise) {
  const Spectrum reflectance(0.9f, 0.5f, 0.1f);
  kit.sphere({0, 0, 0}, 1, kit.material(scene::MirrorMaterial{reflectance}));
  expect_exactly(render(kit.compile(), kAtUnitSphere, square_settings(24, 16)), reflectance);
}

TEST_F(WhiteFurnace, RefractionWithoutReflectionDisappears) {
  kit.sphere({0, 0, 0}, 1, kit.material(scene::RefractionMaterial{Spectrum(1), 1.5f}));
  expect_exactly(render(kit.compile(), kAroundUnitSphere, square_settings(24, 16)), Spectrum(1));
}

TEST_F(WhiteFurnace, GlassDisappears) {
  for (const scene::Fresnel fresnel : {scene::Fresnel::exact, scene::Fresnel::schlick})
    for (const float ior : {1.5f, 2.4f, 1 / 1.33f}) {
      SCOPED_TRACE(fmt::format("Schlick {}, index {}", fresnel == scene::Fresnel::schlick, ior));
      SceneKit with_glass = kit;
      with_glass.sphere({0, 0, 0}, 1,
                        with_glass.material(scene::GlassMaterial{Spectrum(1), Spectrum(1), ior, fresnel}));
      const SampledPicture picture =
          sampled_picture(render(with_glass.compile(), kAroundUnitSphere, square_settings(32, 256)));
      // Only roulette is random: from the third bounce on it ends paths of weight 1 with probability 1 %, and gives the
      // others 1/0.99. 1 − F of the paths enter and are scattered 1 / (1 − F) times within: about one such bounce a
      // path, 0.01 of variance. A pixel that by chance lost no path does not know that, so 0.01 counts at least.
      TestFamily tests;
      for (std::size_t i = 0; i < picture.samples.size(); ++i) {
        const float variance = picture.variance.pixels()[i].r;
        EXPECT_LT(variance, 0.04f) << "pixel " << i;
        const RegionMean pixel{picture.mean.pixels()[i].r, std::sqrt(std::max(variance, 0.01f) / picture.samples[i])};
        tests.add(fmt::format("pixel {}", i), pixel.p_value(1, 1e-5));
      }
      const RunningMean whole = over_pixels(picture.mean, 0);
      EXPECT_LT(whole.standard_error(), 0.0003);
      tests.add("the picture", whole.p_value(1, 1e-5));
      EXPECT_TRUE(tests.holds());
    }
}

// ── Rough metal: the picture against an integral made of textbook formulas, in double precision.

struct Metal {
  Spectrum eta, k;
  scene::Microfacets distribution;
  double alpha;
};

/// Fresnel's equations with a complex index, unpolarised.
double reflectance(double cosine, double eta, double k) {
  const std::complex<double> n(eta, k), cos_t = std::sqrt(1.0 - (1 - cosine * cosine) / (n * n));
  const double s = std::norm((cosine - n * cos_t) / (cosine + n * cos_t));
  const double p = std::norm((n * cosine - cos_t) / (n * cosine + cos_t));
  return 0.5 * (s + p);
}

/// Smith's Λ and the density of normals, Walter et al. 2007 and Heitz 2014.
double smith_lambda(const Metal& metal, double cosine) {
  const double a = cosine / (metal.alpha * std::sqrt(std::max(1 - cosine * cosine, 1e-16)));
  if (metal.distribution == scene::Microfacets::ggx) return 0.5 * (std::sqrt(1 + 1 / (a * a)) - 1);
  return 0.5 * (std::erf(a) - 1) + std::exp(-a * a) / (2 * a * std::sqrt(std::numbers::pi));
}

double normal_density(const Metal& metal, double cosine) {
  const double c2 = cosine * cosine, t2 = (1 - c2) / c2, a2 = metal.alpha * metal.alpha;
  if (metal.distribution == scene::Microfacets::ggx)
    return 1 / (std::numbers::pi * a2 * c2 * c2 * std::pow(1 + t2 / a2, 2));
  return std::exp(-t2 / a2) / (std::numbers::pi * a2 * c2 * c2);
}

/// ∫ f cos θi dωi = ∫ F D G₁ G₁ / (4 cos θo) dωi
double directional_albedo(const Metal& metal, double cos_o, int channel) {
  const double sin_o = std::sqrt(1 - cos_o * cos_o);
  const double visible_o = 1 / (1 + smith_lambda(metal, cos_o));
  const auto integrand = [&](double cos_i, double phi) {
    const double sin_i = std::sqrt(1 - cos_i * cos_i);
    const double x = sin_o + sin_i * std::cos(phi), y = sin_i * std::sin(phi), z = cos_o + cos_i;
    const double l = std::sqrt(x * x + y * y + z * z);
    const double cos_d = (sin_o * x + cos_o * z) / l;
    return reflectance(cos_d, metal.eta[channel], metal.k[channel]) * normal_density(metal, z / l) * visible_o /
           (1 + smith_lambda(metal, cos_i)) / (4 * cos_o);
  };
  return 2 * integrate(integrand, {1e-6, 1, 0, std::numbers::pi}, 1e-5);
}

scene::ConductorMaterial conductor(const Metal& metal) {
  const auto alpha = static_cast<float>(metal.alpha);
  return {metal.eta, metal.k, alpha, alpha, metal.distribution, Spectrum(1)};
}

TEST_F(WhiteFurnace, RoughMetalShowsTheIntegralOfItsSingleScattering) {
  const Spectrum copper_eta(0.2f, 0.92f, 1.1f), copper_k(3.9f, 2.45f, 2.14f);
  TestFamily tests;
  for (const scene::Microfacets distribution : {scene::Microfacets::beckmann, scene::Microfacets::ggx})
    for (const double alpha : {0.2, 0.5})
      for (const float angle_deg : {0.0f, 40.0f, 75.0f}) {
        const Metal metal{copper_eta, copper_k, distribution, alpha};
        SceneKit plane = kit;
        plane.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, plane.material(conductor(metal)));
        const float angle = radians(angle_deg);
        const Camera camera = pinhole({3 * std::sin(angle), 3 * std::cos(angle), 0}, {0, 0, 0}, 1e-4f);
        const Picture picture = render(plane.compile(), camera, square_settings(32, 128));
        for (int c = 0; c < 3; ++c) {
          const double expected = directional_albedo(metal, std::cos(static_cast<double>(angle)), c);
          const RunningMean mean = over_pixels(picture.beauty, c);
          EXPECT_LT(mean.standard_error(), 0.0017 * expected);
          tests.add(fmt::format("GGX {}, alpha {}, {} degrees, channel {}: {} instead of {}",
                                distribution == scene::Microfacets::ggx, alpha, angle_deg, c, mean.mean(), expected),
                    mean.p_value(expected, 1e-4));
        }
      }
  EXPECT_TRUE(tests.holds());
}

TEST_F(WhiteFurnace, RoughMetalReflectsNoMoreThanItGets) {
  for (const scene::Microfacets distribution : {scene::Microfacets::beckmann, scene::Microfacets::ggx})
    for (const double alpha : {0.05, 0.4, 1.0}) {
      const Metal perfect{Spectrum(0), Spectrum(3), distribution, alpha};  // η = 0: no loss at the surface itself
      SceneKit with_sphere = kit;
      with_sphere.sphere({0, 0, 0}, 1, with_sphere.material(conductor(perfect)));
      const SampledPicture picture =
          sampled_picture(render(with_sphere.compile(), kAroundUnitSphere, square_settings(24, 128)));
      TestFamily tests;
      for (std::size_t i = 0; i < picture.samples.size(); ++i) {
        const RegionMean pixel{std::max(picture.mean.pixels()[i].r, 1.0f),
                               std::sqrt(std::max(picture.variance.pixels()[i].r, 1e-4f) / picture.samples[i])};
        tests.add(fmt::format("alpha {}, pixel {}", alpha, i), pixel.p_value(1, 1e-5));
      }
      EXPECT_TRUE(tests.holds());
    }
}

// ── Closed rooms: radiance E everywhere on the walls, albedo ρ, so after n bounces E (1 + ρ + … + ρⁿ).

constexpr std::array<std::array<std::uint32_t, 3>, 12> kBoxTriangles = {{{0, 2, 3},
                                                                         {0, 3, 1},
                                                                         {4, 5, 7},
                                                                         {4, 7, 6},
                                                                         {0, 1, 5},
                                                                         {0, 5, 4},
                                                                         {2, 6, 7},
                                                                         {2, 7, 3},
                                                                         {0, 4, 6},
                                                                         {0, 6, 2},
                                                                         {1, 3, 7},
                                                                         {1, 7, 5}}};

/// A box around the origin whose fronts are inside: one mesh, or six meshes of two triangles.
void add_room(SceneKit& kit, MaterialId material, bool one_mesh) {
  std::vector<Point3> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back((i & 1) ? 1.0f : -1.0f, (i & 2) ? 0.7f : -0.7f, (i & 4) ? 1.3f : -1.3f);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& [a, b, c] : kBoxTriangles) {
    const Vec3 normal = cross(corners[b] - corners[a], corners[c] - corners[a]);
    triangles.push_back(dot(normal, corners[a]) < 0 ? std::array{a, b, c} : std::array{a, c, b});
  }
  if (one_mesh) return kit.mesh(corners, triangles, material);
  for (std::size_t i = 0; i < triangles.size(); i += 2) kit.mesh(corners, {triangles[i], triangles[i + 1]}, material);
}

TEST(ClosedRoom, RadianceIsTheGeometricSeries) {
  const Spectrum emission(1, 0.5f, 0.25f), albedo(0.3f, 0.5f, 0.8f);
  TestFamily tests;
  for (const bool one_mesh : {true, false}) {
    SceneKit kit;
    add_room(kit, kit.material(scene::DiffuseMaterial{albedo}, emission), one_mesh);
    const RenderScene scene = kit.compile();
    for (const int depth : {0, 1, 2, 5, kUnlimitedDepth})
      for (const int light_samples : {0, 2}) {
        RenderSettings settings = square_settings(24, 64, depth);
        settings.light_samples = light_samples;
        const Picture picture = render(scene, pinhole({0.4f, 0.1f, 0.6f}, {-1, 0, -1}, 1), settings);
        for (int c = 0; c < 3; ++c) {
          const double ratio = albedo[c];
          const double missing = depth == kUnlimitedDepth ? 0 : std::pow(ratio, depth + 1);
          const double expected = emission[c] * (1 - missing) / (1 - ratio);
          const RunningMean mean = over_pixels(picture.beauty, c);
          EXPECT_LT(mean.standard_error(), 0.006 * expected);
          tests.add(fmt::format("one mesh {}, depth {}, {} light samples, channel {}: {} instead of {}", one_mesh,
                                depth, light_samples, c, mean.mean(), expected),
                    mean.p_value(expected, 2e-5 * expected));
        }
      }
  }
  EXPECT_TRUE(tests.holds());
}

TEST(ClosedRoom, DiffuseSphereInALuminousRoomShowsItsAlbedo) {
  const Spectrum radiance(2, 1, 0.5f), albedo(0.8f, 0.5f, 0.1f);
  SceneKit kit;
  add_room(kit, kit.emitter(radiance), true);
  kit.sphere({0, 0, 0}, 0.3f, kit.diffuse(albedo));
  const Picture picture = render(kit.compile(), pinhole({0, 0, 1.2f}, {0, 0, 0}, 0.15f), square_settings(24, 64));
  TestFamily tests;
  for (int c = 0; c < 3; ++c) {
    const RunningMean mean = over_pixels(picture.beauty, c);
    EXPECT_LT(mean.standard_error(), 0.004 * radiance[c] * albedo[c]);
    tests.add(fmt::format("channel {}", c), mean.p_value(radiance[c] * albedo[c], 1e-5));
  }
  EXPECT_TRUE(tests.holds());
}

}  // namespace
}  // namespace etendue
