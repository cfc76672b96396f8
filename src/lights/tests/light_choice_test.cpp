#include <gtest/gtest.h>

#include <numeric>

#include "light_kit.h"
#include "lights/light_chooser.h"
#include "testing/statistics.h"

/// Which light a vertex asks: what is said of the probabilities, and that no light is forgotten.
namespace etendue {
namespace {

Point3 somewhere(Random& random, float extent) {
  return Point3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)) * extent;
}

Transform pose(Random& random, float extent) {
  const Frame frame = Frame::from_normal(random.direction());
  return {frame.s, frame.t, frame.n, somewhere(random, extent)};
}

const Geometry& shining_shapes() {
  static const Geometry geometry = [] {
    Geometry made;
    Random random(5);
    for (int i = 0; i < 3; ++i) {
      made.add(DiskShape{pose(random, 2)});
      made.add(CylinderShape{pose(random, 2)});
      made.add(SphereShape{somewhere(random, 2), 0.5f, {0, 1, 0}, {1, 0, 0}, i == 1});
      TriangleMesh quad;
      quad.positions = {{-1, 1, -1}, {2, 1, -1}, {2, 1, 1}, {-1, 1, 1}};
      quad.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
      quad.triangles = {{0, 1, 2}, {0, 2, 3}};
      made.add(std::move(quad));
    }
    made.build();
    return made;
  }();
  return geometry;
}

const Textures& stripes() {
  static const Textures made = [] {
    Image image(4, 1, Spectrum(0));
    image.at(1, 0) = Spectrum(5);
    return Textures{BitmapTexture{Texels(image)}};
  }();
  return made;
}

/// Lights of all kinds that are not at infinity, large and small, bright and dim.
std::vector<Light> soup(int rounds) {
  Random random(3);
  std::vector<Light> lights;
  for (int i = 0; i < rounds; ++i) {
    const Spectrum radiance(std::pow(10.0f, random.between(-3, 3)));
    lights.push_back(PointLight{somewhere(random, 3), radiance});
    SpotLight spot{pose(random, 3), radiance};
    spot.cutoff = random.between(0.01f, 3);
    spot.beam = spot.cutoff * random.value();
    lights.push_back(spot);
    lights.push_back(ProjectorLight{pose(random, 3), random.value() + 0.1f, random.value() + 0.1f, 1, radiance});
    const Transform t = pose(random, 3);
    lights.push_back(RectangleLight{Rectangle(t.origin, t.x * random.value(), t.y * random.value()), radiance});
    lights.push_back(SphereLight{somewhere(random, 3), random.value(), radiance});
    std::vector<MeshLight::Triangle> faces = cube();
    for (MeshLight::Triangle& f : faces) f = triangle(t.point(f.p0), t.point(f.p1), t.point(f.p2));
    lights.push_back(MeshLight(std::move(faces), radiance));
  }
  for (std::uint32_t shape = 0; shape < shining_shapes().shape_count(); ++shape) {
    if (shining_shapes().kind(shape) == Geometry::Kind::mesh) {
      if (shape < 4) lights.push_back(TexturedMeshLight(Glow{&shining_shapes(), &stripes(), shape, std::uint32_t{0}}));
    } else {
      lights.push_back(CurvedLight(Glow{&shining_shapes(), &stripes(), shape, Spectrum(2)}));
    }
  }
  return lights;
}

/// Seen from the side that it faces, as half of it were metal of that width.
Receiver glossy(Receiver at, const Vec3& viewer, float width) {
  at.to_viewer = dot(viewer, at.normal) < 0 ? -viewer : viewer;
  at.gloss = 0.5f;
  at.width2 = square(width);
  return at;
}

/// On and beside the lights, far away, facing all ways or none, some of them glossy.
std::vector<Receiver> receivers(int count) {
  Random random(9);
  std::vector<Receiver> out;
  for (int i = 0; i < count; ++i) {
    const float extent = i % 5 == 0 ? 100.0f : 4.0f;
    out.push_back({somewhere(random, extent), i % 3 == 0 ? Vec3(0) : random.direction()});
    if (i % 3 == 1) out.back() = glossy(out.back(), random.direction(), std::pow(10.0f, random.between(-3, 0)));
  }
  out.push_back({{0, 1, 0}, {0, 1, 0}});        // in the plane of the quads
  out.push_back({{0, 0.9999f, 0}, {1, 0, 0}});  // just before it
  return out;
}

/// By the tree, or all by power.
class LightChoosers : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(, LightChoosers, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "Tree" : "Power"; });

TEST_P(LightChoosers, ChooseAsOftenAsTheySay) {
  std::vector<Light> lights = soup(4);
  lights.push_back(UniformLight{Spectrum(0.5f), true});
  lights.push_back(DirectionalLight{{0, 1, 0}, Spectrum(2)});
  const LightChooser chooser(lights, kScene, GetParam());
  std::vector<std::uint32_t> first(lights.size() + 1, 0);
  for (std::size_t i = 0; i < lights.size(); ++i) first[i + 1] = first[i] + part_count(lights[i]);
  TestFamily family;
  Random random(4);
  constexpr int kSamples = 40000;
  for (const Receiver& at : receivers(30)) {
    std::vector<double> expected, counts(first.back() + 1);
    for (std::uint32_t light = 0; light < lights.size(); ++light)
      for (std::uint32_t part = 0; part < part_count(lights[light]); ++part)
        expected.push_back(kSamples * static_cast<double>(chooser.probability(at, light, part)));
    const double chosen = std::accumulate(expected.begin(), expected.end(), 0.0);
    ASSERT_LE(chosen, kSamples * (1 + 1e-5));
    expected.push_back(std::max(kSamples - chosen, 0.0));  // nothing was found
    for (int i = 0; i < kSamples; ++i) {
      const auto choice = chooser.sample(at, random.value() + random.value() * 0x1p-24);
      if (choice) {
        ASSERT_EQ(choice->probability, chooser.probability(at, choice->light, choice->part));
      }
      ++counts[choice ? first[choice->light] + choice->part : first.back()];
    }
    family.add("a receiver", chi_square_test(counts, expected).p);
  }
  EXPECT_TRUE(family.holds());
}

/// Inside the bounds every light is possible: nothing is lost, and the probabilities sum to 1.
TEST(LightChooser, ProbabilitiesSumToOne) {
  Random random(6);
  std::vector<Light> lights;
  for (int i = 0; i < 1000; ++i) lights.push_back(PointLight{somewhere(random, 3), Spectrum(random.value())});
  const LightChooser chooser(lights, kScene);
  for (const Receiver& at : receivers(50)) {
    double sum = 0;
    for (std::uint32_t light = 0; light < lights.size(); ++light)
      sum += chooser.probability({at.position, Vec3(0)}, light, 0);
    EXPECT_NEAR(sum, 1, 1e-5);
  }
}

TEST_P(LightChoosers, ForgetNoLightThatShines) {
  const std::vector<Light> lights = soup(20);
  const LightChooser chooser(lights, kScene, GetParam());
  Random random(7);
  int shining = 0;
  for (const Receiver& at : receivers(200))
    for (std::uint32_t light = 0; light < lights.size(); ++light)
      for (int i = 0; i < 20; ++i) {
        const auto part =
            std::min(static_cast<std::uint32_t>(random.value() * static_cast<float>(part_count(lights[light]))),
                     part_count(lights[light]) - 1);
        const auto sample = sample_light(lights[light], part, at.position, random.point());
        if (!sample || sample->radiance.is_black() || (at.normal != Vec3(0) && dot(sample->wi, at.normal) <= 0))
          continue;
        ++shining;
        ASSERT_GT(chooser.probability(at, light, part), 0) << light << " of kind " << lights[light].index();
      }
  EXPECT_GT(shining, 100'000);
}

TEST(LightChooser, CopesWithLightsInOnePlace) {
  for (const Point3& place : {Point3(0), Point3(1e6f, 2, 3)}) {
    const std::vector<Light> lights(5000, PointLight{place, Spectrum(1)});
    const LightChooser chooser(lights, kScene);
    for (const Receiver& at : receivers(10)) {
      EXPECT_NEAR(chooser.probability({at.position}, 17, 0) * 5000, 1, 1e-3);
      const auto choice = chooser.sample({at.position}, 0.7);
      ASSERT_TRUE(choice);
      EXPECT_EQ(choice->probability, chooser.probability({at.position}, choice->light, 0));
    }
    EXPECT_GT(chooser.probability({place}, 17, 0), 0);
  }
}

TEST(LightChooser, CopesWithAllMagnitudes) {
  std::vector<Light> lights;
  for (int i = -12; i <= 12; ++i)
    for (int j = -12; j <= 12; ++j) {
      const float x = std::pow(10.0f, static_cast<float>(i));
      lights.push_back(PointLight{{x, 0, 0}, Spectrum(std::pow(10.0f, static_cast<float>(j)))});
    }
  const LightChooser chooser(lights, kScene);
  for (const float y : {0.0f, 1e-6f, 1.0f, 1e6f, 1e12f}) {
    double sum = 0;
    for (std::uint32_t light = 0; light < lights.size(); ++light) {
      const float p = chooser.probability({{0, y, 0}}, light, 0);
      EXPECT_GT(p, 0) << light << ' ' << y;
      sum += p;
    }
    EXPECT_NEAR(sum, 1, 1e-5);
  }
}

TEST(LightChooser, IsTheSameEveryTime) {
  const std::vector<Light> lights = soup(20);
  const LightChooser one(lights, kScene), other(lights, kScene);
  for (const Receiver& at : receivers(20))
    for (std::uint32_t light = 0; light < lights.size(); ++light)
      ASSERT_EQ(one.probability(at, light, 0), other.probability(at, light, 0));
}

/// A hall's ceiling of 64 × 64 lamps.
std::vector<Light> ceiling() {
  std::vector<Light> lights;
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const Point3 corner(static_cast<float>(i), 4, static_cast<float>(j));
      lights.push_back(RectangleLight{Rectangle(corner, {0.2f, 0, 0}, {0, 0, 0.2f}), Spectrum(1)});
    }
  return lights;
}

/// The irradiance by one sample varies far less than by lamps chosen alike.
TEST(LightChooser, FindsTheLampsThatMatter) {
  const std::vector<Light> lights = ceiling();
  const LightChooser chooser(lights, kScene);
  Random random(2);
  RunningMean by_tree, alike;
  const Receiver at{{20, 0, 33}, {0, 1, 0}};
  const auto irradiance = [&](std::uint32_t light, float probability) {
    const auto sample = sample_light(lights[light], 0, at.position, random.point());
    return sample ? sample->radiance.g * dot(sample->wi, at.normal) / (sample->pdf * probability) : 0.0f;
  };
  const auto count = static_cast<float>(lights.size());
  for (int i = 0; i < 100'000; ++i) {
    const auto choice = chooser.sample(at, random.value());
    by_tree.add(choice ? irradiance(choice->light, choice->probability) : 0.0f);
    alike.add(irradiance(static_cast<std::uint32_t>(random.value() * count), 1 / count));
  }
  const double error = std::hypot(by_tree.standard_error(), alike.standard_error());
  EXPECT_LT(std::abs(by_tree.mean() - alike.mean()), 4 * error);
  EXPECT_LT(by_tree.standard_error() * 5, alike.standard_error());
}

TEST(LightChooser, FindsTheLampThatGleams) {
  const LightChooser chooser(ceiling(), kScene);
  const Receiver matt{{8, 0, 8.5f}, {0, 1, 0}};
  const std::uint32_t mirrored = 40 * 64 + 8;
  const Receiver metal = glossy(matt, normalize(Vec3(-32.1f, 4, 0.4f)), 0.05f);
  EXPECT_GT(chooser.probability(metal, mirrored, 0), 30 * chooser.probability(matt, mirrored, 0));
}

TEST(LightChooser, AsksTheOnlyLightThereIs) {
  const std::vector<Light> lights = {RectangleLight{Rectangle({0, 0, 0}, {1, 0, 0}, {0, 0, 1}), Spectrum(1)}};
  const LightChooser chooser(lights, kScene);
  EXPECT_TRUE(chooser.is_certain());
  EXPECT_EQ(chooser.sample({{0, 5, 0}, {0, -1, 0}}, 0.3)->probability, 1);
  EXPECT_EQ(chooser.probability({{0, 5, 0}, {0, -1, 0}}, 0, 0), 1);
}

/// The sky is asked near a lamp, and the lamp under a bright sky.
TEST(LightChooser, AlwaysLeavesSomeToTheSkyAndToTheLamps) {
  for (const float sky : {1e-6f, 1e6f}) {
    const std::vector<Light> lights = {PointLight{{0, 1, 0}, Spectrum(1)}, UniformLight{Spectrum(sky)}};
    const LightChooser chooser(lights, kScene);
    const Receiver at{{0, 0, 0}, {0, 1, 0}};
    EXPECT_NEAR(chooser.probability(at, sky > 1 ? 0 : 1, 0), LightChooser::kLeastShare, 1e-6);
    EXPECT_NEAR(chooser.probability(at, 0, 0) + chooser.probability(at, 1, 0), 1, 1e-6);
    EXPECT_EQ(chooser.probability({{0, 2, 0}, {0, 1, 0}}, 1, 0), 1);  // the lamp is behind
  }
}

}  // namespace
}  // namespace etendue
