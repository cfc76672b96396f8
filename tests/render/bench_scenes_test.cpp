// The scenes of scenes/bench: no technique changes what they show, and all techniques together give the same picture
// to the bit, however the work is cut.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "camera/placement.h"
#include "formats/formats.h"
#include "picture_statistics.h"
#include "render/session.h"
#include "technique_comparison.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

const Technique kPlain{.name = "plain paths"};
const Technique kPhotons{.name = "photons", .photons = Use::on};
const Technique kReuse{.name = "reuse", .reuse = Use::on};
const Technique kCache{.name = "cache", .cache = Use::on};
/// What glass shows of a small lamp itself is seldom found: where that is compared, both must look for it alike.
const Technique kPhotonsBothWays{.name = "photons, splitting", .photons = Use::on, .splitting = Use::on};
const Technique kPhotonsAndCache{.name = "photons, cache", .photons = Use::on, .cache = Use::on};
const Technique kAirlight{.name = "airlight", .airlight = Use::on};
const Technique kAll{.name = "all",
                     .integrator = IntegratorKind::automatic,
                     .photons = Use::automatic,
                     .reuse = Use::automatic,
                     .cache = Use::automatic,
                     .airlight = Use::automatic};

void unchanged(scene::SceneDescription&) {}

/// Lamps are `factor` times as wide, and give as much light.
template <int factor>
void widened(scene::SceneDescription& description) {
  constexpr auto kScale = static_cast<float>(factor);
  for (scene::Instance& instance : description.instances)
    if (emits(description.materials[instance.material.index]))
      instance.to_world = instance.to_world * Transform::scaling(Vec3(kScale, kScale, kScale));
  for (scene::Material& material : description.materials)
    if (auto* emission = std::get_if<Spectrum>(&material.emission)) *emission *= 1 / square(kScale);
}

/// Fog up to below the lamp.
void with_low_fog(scene::SceneDescription& description) {
  for (scene::Instance& instance : description.instances)
    if (instance.separates_media) instance.to_world = Transform::scaling({1, 0.5f, 1}) * instance.to_world;
}

/// A scene, what is compared there, and how well.
struct Comparison {
  std::string name, scene;
  void (*easier)(scene::SceneDescription&) = unchanged;
  Technique reference = kPlain;
  std::vector<Technique> techniques;
  int width = 240;  ///< in pixels. Photons and cells blur by so many pixels: 480 where that showed
  int samples = 4;
  int seeds = 12;
  double error = 0.002;  ///< standard error that the difference of the picture's mean may have, relative
};

std::ostream& operator<<(std::ostream& out, const Comparison& comparison) {
  return out << comparison.name;
}

struct BenchScene {
  RenderScene scene;
  Camera camera;
  RenderSettings settings;
};

BenchScene open(const std::string& name, int width, int height, void (*change)(scene::SceneDescription&) = unchanged) {
  Diagnostics diagnostics;
  scene::SceneDescription description = read_scene(fmt::format("{}/bench/{}.xml", SCENES_FOLDER, name), diagnostics);
  change(description);
  RenderScene scene = compile(description, {}, diagnostics);
  const Camera camera = place_camera(description, scene.bounds(), CameraPlacement::file, width, height, diagnostics);
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  settings.max_depth = description.hints.max_depth.value();
  return {std::move(scene), camera, settings};
}

/// Means over one picture: over its 3 × 3 blocks, and over the whole.
constexpr int kSide = 3, kParts = kSide * kSide + 1, kWhole = kParts - 1;
using Means = std::array<Spectrum, kParts>;

Means means_of(const Image& image) {
  const int width = image.width() / kSide, height = image.height() / kSide;
  Means means{};
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) means[y / height * kSide + x / width] += image.at(x, y);
  for (int part = 0; part < kWhole; ++part) {
    means[part] *= 1 / static_cast<float>(width * height);
    means[kWhole] += means[part] * (1 / static_cast<float>(kWhole));
  }
  return means;
}

/// The means of every seed.
std::vector<Means> rendered(const BenchScene& bench, const Technique& technique, const Comparison& comparison) {
  RenderSettings settings = with(technique, bench.settings);
  settings.samples_per_pixel = comparison.samples;
  std::vector<Means> means;
  for (int seed = 1; seed <= comparison.seeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    means.push_back(means_of(render(bench.scene, bench.camera, settings).beauty));
  }
  return means;
}

/// Pictures of one seed share random numbers. Welch's test takes them for independent and so errs on the safe side; of
/// noise that both have, Student's test of their differences sees nothing.
void expect_same_means(const std::vector<Means>& reference, const std::vector<Means>& other, const Technique& technique,
                       const Comparison& comparison) {
  TestFamily tests;
  for (int part = 0; part < kParts; ++part)
    for (int c = 0; c < 3; ++c) {
      RunningMean a, b, difference;
      for (std::size_t seed = 0; seed < reference.size(); ++seed) {
        a.add(reference[seed][part][c]);
        b.add(other[seed][part][c]);
        difference.add(other[seed][part][c] - reference[seed][part][c]);
      }
      const double rounding = 1e-5 * a.mean();
      const double relative_error = difference.standard_error() / a.mean();
      if (part == kWhole) {
        EXPECT_LT(relative_error, comparison.error) << "channel " << c;
      }
      if (c == 1)
        fmt::print("{}{:+.2f} ± {:.2f}{}", part == 0 ? fmt::format("{}, {}: ", comparison.name, technique.name) : ", ",
                   100 * difference.mean() / a.mean(), 100 * relative_error, part == kWhole ? " %\n" : "");
      const std::string where =
          fmt::format("part {}, channel {}: {} ± {} and {} ± {}, difference ± {}", part, c, a.mean(),
                      a.standard_error(), b.mean(), b.standard_error(), difference.standard_error());
      tests.add(where + ", Welch's test", a.p_value(b, rounding));
      tests.add(where + ", test of differences", difference.student_p_value(0, rounding));
    }
  EXPECT_TRUE(tests.holds());
}

class BenchScenes : public ::testing::TestWithParam<Comparison> {};

TEST_P(BenchScenes, TechniquesDoNotChangeMeans) {
  const Comparison& comparison = GetParam();
  const BenchScene bench = open(comparison.scene, comparison.width, comparison.width * 3 / 4, comparison.easier);
  const std::vector<Means> reference = rendered(bench, comparison.reference, comparison);
  for (const Technique& technique : comparison.techniques) {
    SCOPED_TRACE(technique.name);
    expect_same_means(reference, rendered(bench, technique, comparison), technique, comparison);
  }
}

/// Plain paths do not find the caustics of the smallest lamps and the sun, and fog next to a lamp, often enough to be
/// compared with: there what does not change them is compared with plain paths, the rest among techniques, and with
/// plain paths where lamps are wider and fog is lower.
const std::vector<Technique> kOnSurfaces{kPhotons, kReuse, kCache, kAll};
/// Nothing there is for photons to go by.
const std::vector<Technique> kWithoutMirrors{kReuse, kCache, kAll};

INSTANTIATE_TEST_SUITE_P(
    , BenchScenes,
    ::testing::Values(
        Comparison{.name = "Spheres", .scene = "a-spheres", .techniques = kOnSurfaces},
        Comparison{.name = "SmallLight", .scene = "b-small-light", .techniques = {kReuse}, .seeds = 6},
        Comparison{.name = "SmallLightByPhotons",
                   .scene = "b-small-light",
                   .reference = kPhotonsBothWays,
                   .techniques = {kAll}},
        Comparison{.name = "SmallLightByPhotonsAndCache",
                   .scene = "b-small-light",
                   .reference = kPhotons,
                   .techniques = {kPhotonsAndCache},
                   .width = 480,
                   .samples = 2,
                   .seeds = 8},
        Comparison{.name = "SmallLightWidened",
                   .scene = "b-small-light",
                   .easier = widened<3>,
                   .techniques = {kPhotons, kAll},
                   .error = 0.003},
        Comparison{.name = "Water", .scene = "c-water", .techniques = {kReuse, kCache}, .seeds = 6},
        Comparison{.name = "WaterUnderAWideLamp",
                   .scene = "c-water",
                   .easier = widened<20>,
                   .techniques = {kPhotons, kAll},
                   .width = 480,
                   .samples = 2,
                   .seeds = 8,
                   .error = 0.003},
        Comparison{.name = "MeshInMuseum",
                   .scene = "d-mesh-museum",
                   .techniques = kOnSurfaces,
                   .width = 480,
                   .samples = 2,
                   .seeds = 8,
                   .error = 0.003},
        Comparison{.name = "MeshInSun", .scene = "d-mesh-sun", .techniques = {kReuse, kCache}, .seeds = 6},
        Comparison{.name = "MeshInSunByPhotons",
                   .scene = "d-mesh-sun",
                   .reference = kPhotons,
                   .techniques = {kPhotonsAndCache, kAll},
                   .error = 0.003},
        Comparison{.name = "AjarDoor",
                   .scene = "e-ajar-door",
                   .techniques = kWithoutMirrors,
                   .width = 480,
                   .samples = 2,
                   .seeds = 8,
                   .error = 0.0035},
        Comparison{
            .name = "ManyLights", .scene = "f-many-lights", .techniques = kWithoutMirrors, .seeds = 6, .error = 0.003},
        Comparison{.name = "VeachMis", .scene = "g-veach-mis", .techniques = kWithoutMirrors, .error = 0.006},
        Comparison{
            .name = "FogSpot", .scene = "h-fog-spot", .reference = kAirlight, .techniques = {kAll}, .error = 0.01},
        Comparison{.name = "FogBelowTheSpot",
                   .scene = "h-fog-spot",
                   .easier = with_low_fog,
                   .techniques = {kAirlight, kCache, kAll},
                   .seeds = 20,
                   .error = 0.005}),
    [](const auto& test) { return test.param.name; });

/// A part of each picture through three generations of photons and cells; the second pass ends within one.
class BenchScenesToTheBit : public ::testing::TestWithParam<std::string> {};

TEST_P(BenchScenesToTheBit, HoweverTheWorkIsCut) {
  const BenchScene bench = open(GetParam(), 256, 192);
  RenderSettings settings = bench.settings;
  settings.crop = CropWindow{110, 90, 45, 35};
  settings.samples_per_pixel = 48;
  const auto picture = [&](int threads, int tile_size, const std::vector<int>& passes) {
    const ThreadLimit limit(threads);
    settings.tile_size = tile_size;
    RenderSession session(bench.scene, bench.camera, settings);
    for (const int samples : passes) session.render_pass({}, samples);
    EXPECT_TRUE(session.finished());
    return session.snapshot();
  };
  const Picture expected = picture(1, 16, {48});
  EXPECT_TRUE(identical(picture(2, 16, {48}), expected));
  EXPECT_TRUE(identical(picture(2, 5, {16, 32}), expected));
  EXPECT_TRUE(identical(picture(2, 16, {1, 19, 48}), expected));
}

INSTANTIATE_TEST_SUITE_P(, BenchScenesToTheBit,
                         ::testing::Values("a-spheres", "b-small-light", "c-water", "d-mesh-museum", "d-mesh-sun",
                                           "e-ajar-door", "f-many-lights", "g-veach-mis", "h-fog-spot"),
                         [](const auto& test) {
                           std::string name;
                           for (const char c : test.param)
                             if (c != '-') name += c;
                           return name;
                         });

}  // namespace
}  // namespace etendue
