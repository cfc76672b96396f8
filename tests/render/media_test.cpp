// Participating media, held against what is known of them.

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "picture_statistics.h"
#include "scene_kit.h"
#include "testing/quadrature.h"
#include "testing/random.h"
#include "volumes/volume.h"

namespace etendue {
namespace {

using MediumId = scene::Id<scene::Medium>;

scene::Medium homogeneous(const Spectrum& sigma_t, const Spectrum& albedo,
                          const scene::Phase& phase = scene::IsotropicPhase{}) {
  scene::Medium medium;
  medium.sigma_t = sigma_t;
  medium.albedo = albedo;
  medium.phase = phase;
  return medium;
}

/// Values on a grid over the box from (−1, −1, −1) to (1, 1, 1).
scene::Volume blocks(int channels, float most, std::uint64_t seed) {
  Random random(seed);
  scene::GridVolume grid;
  grid.size = {4, 5, 6};
  grid.channels = channels;
  for (int i = 0; i < 120 * channels; ++i) grid.values.push_back(random.between(0, most));
  scene::Volume volume;
  volume.source = std::move(grid);
  volume.to_world = Transform::translation({-1, -1, -1}) * Transform::scaling({2, 2, 2});
  return volume;
}

scene::Medium heterogeneous(SceneKit& kit, const scene::Volume& sigma_t, float scale, const Spectrum& albedo,
                            const scene::Phase& phase = scene::IsotropicPhase{}) {
  scene::Medium medium = homogeneous(Spectrum(0), albedo, phase);
  medium.sigma_t = kit.volume(sigma_t);
  medium.scale = scale;
  return medium;
}

/// A ball of the medium around the origin behind a boundary that does nothing.
void add_ball(SceneKit& kit, float radius, std::optional<MediumId> inside) {
  kit.sphere({0, 0, 0}, radius, kit.material(scene::NullMaterial{}));
  if (inside) kit.fill_last(*inside);
}

constexpr float kNarrow = 0.002f;  // half a picture: rays through it are as good as parallel
const Camera kFromOutside = pinhole({0, 0, 4}, {0, 0, 0}, kNarrow);
const Camera kAroundBall = pinhole({0, 0.5f, 4}, {0, 0, 0}, 0.3f);
const Camera kFromCentre = pinhole({0, 0, 0}, {0.3f, 0.2f, -1}, 1);

void expect_means(TestFamily& tests, const std::string& name, const Image& beauty, const Spectrum& expected,
                  double precision) {
  for (int c = 0; c < 3; ++c) {
    const RunningMean mean = over_pixels(beauty, c);
    EXPECT_LT(mean.standard_error(), precision * expected[c]) << name;
    tests.add(fmt::format("{}, channel {}: {} instead of {}", name, c, mean.mean(), expected[c]),
              mean.p_value(expected[c], 2e-5 * expected[c]));
  }
}

TEST(Media, DimWhatShinesThroughByBeersLaw) {
  const Spectrum sigma(0.1f, 0.7f, 1.5f);
  SceneKit kit;
  kit.light(scene::ConstantLight{Spectrum(1)});
  const MediumId medium = kit.medium(homogeneous(sigma, Spectrum(0)));
  add_ball(kit, 1, medium);
  TestFamily tests;
  const auto dimmed = [&](float length) {
    return Spectrum(std::exp(-sigma.r * length), std::exp(-sigma.g * length), std::exp(-sigma.b * length));
  };
  expect_means(tests, "from outside", render(kit.compile(), kFromOutside, square_settings(24, 256)).beauty, dimmed(2),
               0.006);
  kit.camera_in(medium);
  expect_means(tests, "from the centre", render(kit.compile(), kFromCentre, square_settings(24, 256)).beauty, dimmed(1),
               0.006);
  EXPECT_TRUE(tests.holds());
}

TEST(Media, DimShadowRaysByBeersLaw) {
  // Straight down from the lamp to the floor, through the ball; the camera looks from the side, past it.
  SceneKit kit;
  kit.quad({-5, -2, 5}, {10, 0, 0}, {0, 0, -10}, kit.diffuse(Spectrum(1)));
  kit.light(scene::PointLight{Spectrum(kPi * 16)}, Transform::translation({0, 2, 0}));
  const scene::Volume density = blocks(3, 2, 7);
  add_ball(kit, 1, kit.medium(heterogeneous(kit, density, 1, Spectrum(0))));
  const Volume volume(density);
  Spectrum expected;
  for (int c = 0; c < 3; ++c)
    expected[c] = static_cast<float>(std::exp(-integrate(
        [&](double y) {
          return static_cast<double>(volume.lookup({0, static_cast<float>(y), 0})[c]);
        },
        -1, 1)));
  const Camera camera = pinhole({6, -1, 0}, {0, -2, 0}, 0.0005f);
  TestFamily tests;
  expect_means(tests, "ratio tracking", render(kit.compile(), camera, square_settings(16, 256)).beauty, expected,
               0.006);
  EXPECT_TRUE(tests.holds());
}

/// Radiance of light that a ball of radius 1 in uniform light of radiance 1 sends along its diameter after at most one
/// scattering.
double single_scattering(double sigma, double albedo, double g) {
  const auto phase = [&](double cosine) { return (1 - g * g) / (4 * kPi * std::pow(1 + g * g - 2 * g * cosine, 1.5)); };
  // s: way back from the scattering to where the light leaves; light comes from the direction whose cosine to the
  // diameter is −c and has come a distance of r c + √(1 − r²(1 − c²)) through the ball, r = s − 1.
  const auto arriving = [&](double s) {
    const double r = s - 1;
    return integrate(
        [&](double c) {
          return 2 * kPi * phase(c) * std::exp(-sigma * (r * -c + std::sqrt(std::max(0.0, 1 - r * r * (1 - c * c)))));
        },
        -1, 1, 1e-7);
  };
  return std::exp(-2 * sigma) +
         integrate([&](double s) { return sigma * albedo * std::exp(-sigma * s) * arriving(s); }, 0, 2, 1e-6);
}

TEST(Media, ScatterOnceAsTheIntegralSays) {
  const Spectrum sigma(0.3f, 1, 2), albedo(0.9f, 0.5f, 1);
  TestFamily tests;
  for (const float g : {0.0f, 0.6f, -0.6f}) {
    SceneKit kit;
    kit.light(scene::ConstantLight{Spectrum(1)});
    add_ball(kit, 1, kit.medium(homogeneous(sigma, albedo, scene::HenyeyGreensteinPhase{g})));
    Spectrum expected;
    for (int c = 0; c < 3; ++c) expected[c] = static_cast<float>(single_scattering(sigma[c], albedo[c], g));
    for (const int light_samples : {0, 2}) {
      RenderSettings settings = square_settings(24, 256, 1);
      settings.light_samples = light_samples;
      expect_means(tests, fmt::format("g = {}, {} light samples", g, light_samples),
                   render(kit.compile(), kFromOutside, settings).beauty, expected, 0.005);
    }
  }
  EXPECT_TRUE(tests.holds());
}

/// Radiance of light from a point of intensity 1, `distance` beside a ray's point `ahead` of its origin, that is
/// scattered once towards the origin from at most `end` away, in a medium without bounds.
double airlight(double sigma, double albedo, double g, double distance, double ahead, double end) {
  const auto from_angle = [&](double angle) {  // at the light, from the ray's nearest point: dt / d² = dθ / distance
    const double t = ahead + distance * std::tan(angle), d = distance / std::cos(angle);
    // The cosine of the angle by which light is turned is −sin θ.
    const double turned = 1 + g * g + 2 * g * std::sin(angle);
    return std::exp(-sigma * (t + d)) * (1 - g * g) / (4 * kPi * std::pow(turned, 1.5)) / distance;
  };
  return sigma * albedo *
         integrate(from_angle, std::atan(-ahead / distance), std::atan((end - ahead) / distance), 1e-9);
}

TEST(Media, ScatterAirlightOfAPointAsTheIntegralSays) {
  const Spectrum sigma(0.1f, 0.4f, 1.5f), albedo(0.9f, 0.6f, 1);
  TestFamily tests;
  for (const float g : {0.0f, 0.5f})
    for (const bool wall : {false, true})
      for (const int light_samples : {0, 1}) {
        SceneKit kit;
        const MediumId medium = kit.medium(homogeneous(sigma, albedo, scene::HenyeyGreensteinPhase{g}));
        kit.camera_in(medium);
        kit.light(scene::PointLight{Spectrum(20)}, Transform::translation({0.5f, 0, -3}));
        kit.quad({-9, -9, wall ? -4.0f : 50.0f}, {18, 0, 0}, {0, 18, 0}, kit.material(scene::NoReflection{}));
        Spectrum expected;
        for (int c = 0; c < 3; ++c)
          expected[c] = static_cast<float>(20 * airlight(sigma[c], albedo[c], g, 0.5, 3, wall ? 4 : 1e4));
        RenderSettings settings = square_settings(16, 256, 1);
        settings.light_samples = light_samples;
        settings.airlight = Use::on;
        expect_means(tests, fmt::format("g = {}, wall {}, {} light samples", g, wall, light_samples),
                     render(kit.compile(), pinhole({0, 0, 0}, {0, 0, -1}, 1e-4f), settings).beauty, expected, 0.002);
      }
  EXPECT_TRUE(tests.holds());
}

TEST(Media, GatherTheSameLightAlongTheWayAsWherePathsAreScattered) {
  // Lamps of all kinds, within the fog and outside it, objects in it, slats before the spot light.
  SceneKit kit;
  const MediumId fog =
      kit.medium(homogeneous(Spectrum(0.2f, 0.5f, 1), Spectrum(0.9f), scene::HenyeyGreensteinPhase{0.4f}));
  kit.quad({-3, -1.2f, 3}, {6, 0, 0}, {0, 0, -6}, kit.diffuse(Spectrum(0.5f)));
  kit.sphere({-0.4f, -0.3f, 0.2f}, 0.3f, kit.material(scene::GlassMaterial{}));
  kit.sphere({0.6f, 0.5f, -0.3f}, 0.15f, kit.emitter(Spectrum(4)));
  for (const float x : {-0.3f, 0.1f, 0.5f})
    kit.quad({x, 1.5f, -0.5f}, {0.2f, 0, 0}, {0, 0, 1}, kit.diffuse(Spectrum(0.2f)));
  const Transform down = Transform::translation({0.2f, 2.2f, 0}) * Transform::rotation({1, 0, 0}, -0.5f * kPi);
  kit.light(scene::SpotLight{Spectrum(30, 25, 20), 30, 0, 20}, down);
  kit.light(scene::PointLight{Spectrum(2)}, Transform::translation({-0.5f, 0.4f, 0.3f}));
  kit.light(scene::PointLight{Spectrum(3)}, Transform::translation({1.8f, 0.5f, 1}));
  kit.light(scene::ProjectorLight{}, Transform::translation({0, 0, 3}));
  kit.light(scene::ConstantLight{Spectrum(0.1f)});
  add_ball(kit, 1.4f, fog);
  const RenderScene scene = kit.compile();
  TestFamily tests;
  for (const int depth : {1, 2, kUnlimitedDepth})
    for (const int light_samples : {0, 2}) {
      RenderSettings settings = square_settings(24, 256, depth);
      settings.light_samples = light_samples;
      settings.airlight = Use::on;
      const SampledPicture on = sampled_picture(render(scene, kAroundBall, settings));
      settings.airlight = Use::off;
      settings.seed = 1;
      settings.samples_per_pixel = 512;
      const SampledPicture off = sampled_picture(render(scene, kAroundBall, settings));
      for (int y = 0; y < 24; y += 8)
        for (int x = 0; x < 24; x += 8)
          for (int c = 0; c < 3; ++c) {
            const RegionMean a = region_mean(on, {x, y, 8, 8}, c), b = region_mean(off, {x, y, 8, 8}, c);
            tests.add(fmt::format("depth {}, {} light samples, ({}, {}), channel {}: {} instead of {}", depth,
                                  light_samples, x, y, c, a.mean, b.mean),
                      a.p_value(b));
          }
      const CropWindow all{0, 0, 24, 24};
      EXPECT_LT(region_mean(on, all, 1).error, 0.01 * region_mean(on, all, 1).mean);
    }
  EXPECT_TRUE(tests.holds());
}

TEST(Media, ThatAbsorbNothingDisappearInUniformLight) {
  TestFamily tests;
  for (const scene::Phase& phase :
       {scene::Phase(scene::IsotropicPhase{}), scene::Phase(scene::HenyeyGreensteinPhase{0.8f})})
    for (const bool grid : {false, true})
      for (const bool glass : {false, true}) {
        SceneKit kit;
        kit.light(scene::ConstantLight{Spectrum(1)});
        const MediumId medium = kit.medium(grid ? heterogeneous(kit, blocks(3, 4, 3), 1, Spectrum(1), phase)
                                                : homogeneous(Spectrum(0.5f, 1, 4), Spectrum(1), phase));
        kit.sphere(
            {0, 0, 0}, 1,
            kit.material(glass ? scene::Surface(scene::GlassMaterial{}) : scene::Surface(scene::NullMaterial{})));
        kit.fill_last(medium);
        kit.sphere({0, 0, 0}, 0.4f, kit.material(scene::NullMaterial{}));
        const std::string name = fmt::format("phase {}, grid {}, glass {}", phase.index(), grid, glass);
        expect_means(tests, name, render(kit.compile(), kAroundBall, square_settings(20, 128)).beauty, Spectrum(1),
                     0.006);
        // Within glass of index n, radiance is n² of that outside.
        kit.camera_in(medium);
        expect_means(tests, name + ", from the centre",
                     render(kit.compile(), kFromCentre, square_settings(20, 128)).beauty,
                     Spectrum(glass ? 2.25f : 1.0f), 0.012);
      }
  EXPECT_TRUE(tests.holds());
}

/// Lamps of all kinds of size in and around a cloud over a floor.
void add_lit_cloud(SceneKit& kit, const Spectrum& scale) {
  kit.quad({-3, -1.2f, 3}, {6, 0, 0}, {0, 0, -6}, kit.diffuse(Spectrum(0.5f)));
  kit.light(scene::PointLight{Spectrum(4)}, Transform::translation({1.5f, 1.5f, 1}));
  kit.light(scene::ConstantLight{Spectrum(0.2f)});
  kit.sphere({0.3f, 0.2f, 0.1f}, 0.2f, kit.emitter(Spectrum(8)));
  scene::Volume density = blocks(3, 2, 5);
  auto& values = std::get<scene::GridVolume>(density.source).values;
  for (std::size_t i = 0; i < values.size(); i += 3) {
    const float grey = values[i];
    for (int c = 0; c < 3; ++c) values[i + c] = grey * scale[c];
  }
  kit.sphere({0, 0, 0}, 1, kit.material(scene::NullMaterial{}));
  kit.fill_last(kit.medium(heterogeneous(kit, density, 1, Spectrum(0.9f), scene::HenyeyGreensteinPhase{0.5f})));
}

TEST(Media, EachColourIsAsIfItWereAlone) {
  const Spectrum scale(0.3f, 1, 2.5f);
  const auto picture_of = [](const Spectrum& s) {
    SceneKit kit;
    add_lit_cloud(kit, s);
    return sampled_picture(render(kit.compile(), kAroundBall, square_settings(24, 256)));
  };
  const SampledPicture coloured = picture_of(scale);
  TestFamily tests;
  for (int c = 0; c < 3; ++c) {
    const SampledPicture grey = picture_of(Spectrum(scale[c]));
    const RegionMean a = region_mean(coloured, {0, 0, 24, 24}, c), b = region_mean(grey, {0, 0, 24, 24}, c);
    EXPECT_LT(a.error + b.error, 0.02 * b.mean);
    tests.add(fmt::format("channel {}: {} instead of {}", c, a.mean, b.mean), a.p_value(b));
  }
  EXPECT_TRUE(tests.holds());
}

TEST(Media, BoundariesOfNothingChangeNothing) {
  const auto picture_of = [](bool boundary, bool some_medium) {
    SceneKit kit;
    kit.quad({-3, -1.2f, 3}, {6, 0, 0}, {0, 0, -6}, kit.diffuse(Spectrum(0.5f)));
    kit.sphere({0.3f, 0.2f, 0.1f}, 0.2f, kit.emitter(Spectrum(8)));
    kit.light(scene::PointLight{Spectrum(4)}, Transform::translation({0.5f, 0.5f, 0.5f}));
    if (some_medium) kit.medium(homogeneous(Spectrum(1), Spectrum(1)));
    if (boundary) add_ball(kit, 1, std::nullopt);
    return sampled_picture(render(kit.compile(), kAroundBall, square_settings(32, 128)));
  };
  const SampledPicture nothing = picture_of(false, false);
  EXPECT_GE(compare_in_blocks(nothing, picture_of(true, true), 4).agreeing_share, kAgreeingShare);
  EXPECT_GE(compare_in_blocks(nothing, picture_of(true, false), 4).agreeing_share, kAgreeingShare);
}

TEST(Media, ThinGlassAndMasksLetLightIntoThem) {
  // A mask of one half around absorbing air: half of what comes is dimmed by the ball, twice masked; the rest shows the
  // black mask.
  SceneKit kit;
  kit.light(scene::ConstantLight{Spectrum(1)});
  const MaterialId black = kit.material(scene::NoReflection{});
  kit.sphere({0, 0, 0}, 1, kit.material(scene::MaskMaterial{black, 0.5f}));
  kit.fill_last(kit.medium(homogeneous(Spectrum(0.5f), Spectrum(0))));
  TestFamily tests;
  expect_means(tests, "mask", render(kit.compile(), kFromOutside, square_settings(24, 256)).beauty,
               Spectrum(0.25f * std::exp(-1.0f)), 0.02);
  EXPECT_TRUE(tests.holds());
}

TEST(Media, GiveTheSamePictureForAnyThreadsAndTiles) {
  SceneKit kit;
  add_lit_cloud(kit, Spectrum(0.3f, 1, 2));
  const RenderScene scene = kit.compile();
  RenderSettings settings = square_settings(20, 16);
  settings.sampler = SamplerKind::sobol;
  const Picture expected = render(scene, kAroundBall, settings);
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(identical(render(scene, kAroundBall, settings), expected)) << threads << " threads";
  }
  for (const int tile_size : {1, 7}) {
    settings.tile_size = tile_size;
    EXPECT_TRUE(identical(render(scene, kAroundBall, settings), expected)) << "tiles of " << tile_size;
  }
}

TEST(Media, HaveTheirImpossibleValuesRepairedAndCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  SceneKit kit;
  kit.light(scene::ConstantLight{Spectrum(1)});
  add_ball(kit, 1,
           kit.medium(homogeneous(Spectrum(-1, nan, infinite), Spectrum(2), scene::HenyeyGreensteinPhase{nan})));
  scene::Volume density = blocks(1, 1e30f, 9);
  std::get<scene::GridVolume>(density.source).values[3] = nan;
  std::get<scene::GridVolume>(density.source).values[4] = -1;
  add_ball(kit, 0.5f, kit.medium(heterogeneous(kit, density, 1, Spectrum(1))));
  scene::Volume flat;
  flat.source = scene::GridVolume{{1, 1, 1}, 1, {1.0f}};
  flat.to_world = Transform::scaling({1, 0, 1});
  kit.medium(heterogeneous(kit, flat, -1, Spectrum(1)));
  Diagnostics diagnostics;
  const RenderScene scene = compile(kit.description(), {}, diagnostics);
  std::vector<std::string> said;
  for (const Diagnostic& d : diagnostics.all()) said.push_back(fmt::format("{} × {}", d.count, d.message));
  const auto counted = [&](std::string_view what, int times) {
    return std::ranges::any_of(
        said, [&](const std::string& s) { return s.starts_with(fmt::format("{} × {}", times, what)); });
  };
  EXPECT_TRUE(counted("extinction of a medium", 3)) << fmt::format("{}", fmt::join(said, "\n"));
  EXPECT_TRUE(counted("albedo of a medium", 1));
  EXPECT_TRUE(counted("mean cosine", 1));
  EXPECT_TRUE(counted("medium so dense", 1));
  EXPECT_TRUE(counted("volume without extent", 1));
  EXPECT_TRUE(counted("scale of a medium", 1));
  render(scene, kAroundBall, square_settings(8, 4));
}

}  // namespace
}  // namespace etendue
