// What the lens does to a point, and what the camera cuts away.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "picture_statistics.h"
#include "scene_kit.h"

namespace etendue {
namespace {

/// Moments of a picture of one light on the axis, in film coordinates at distance 1, weighted by brightness.
struct SpotMoments {
  double total = 0;       ///< mean brightness of the picture
  double r2 = 0, r4 = 0;  ///< of the distance to the axis
  double third = 0;       ///< ⟨r³ cos 3φ⟩, φ from +x to +y: which way a triangle points
};

SpotMoments measure(const Image& image, const Camera& camera) {
  SpotMoments m;
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const double weight = image.at(x, y).g;
      const double u = (2 * (x + 0.5) / image.width() - 1) * camera.tan_half_x;
      const double v = (1 - 2 * (y + 0.5) / image.height()) * camera.tan_half_y;
      const double r2 = u * u + v * v;
      sum += weight;
      m.r2 += weight * r2;
      m.r4 += weight * r2 * r2;
      m.third += weight * (u * u * u - 3 * u * v * v);
    }
  m.total = sum / static_cast<double>(image.pixels().size());
  m.r2 /= sum;
  m.r4 /= sum;
  m.third /= sum;
  return m;
}

constexpr float kLensRadius = 0.2f, kFocus = 3;
constexpr float kEmitterTangent = 0.004f;  // radius / distance of the light

/// A picture of a small luminous ball on the axis at `distance`.
struct PointPicture {
  Camera camera;
  SpotMoments moments;
};

PointPicture picture_of_point(float distance, int blades, float lens_radius = kLensRadius) {
  SceneKit kit;
  kit.sphere({0, 0, -distance}, kEmitterTangent * distance, kit.emitter(Spectrum(1)));
  PointPicture out;
  out.camera = pinhole({0, 0, 0}, {0, 0, -1}, 0.06f);
  out.camera.lens_radius = lens_radius;
  out.camera.focal_distance = kFocus;
  out.camera.blades = blades;
  const Picture picture = render(kit.compile(), out.camera, square_settings(96, 256, 0));
  out.moments = measure(picture.beauty, out.camera);
  return out;
}

/// Similar triangles: a point of the lens at r is seen on the film at r (d − f) / (d f).
double blur_scale(double distance) {
  return (distance - kFocus) / (distance * kFocus);
}

/// ⟨r²⟩ on the film of what blurs besides the lens: the ball's own disk and the pixels' squares.
double other_blur(const Camera& camera) {
  const double pixel = 2 * camera.tan_half_x / 96;
  return kEmitterTangent * kEmitterTangent / 2 + pixel * pixel / 6;
}

constexpr float kDistances[] = {1.7f, 2.3f, 4.5f, 9};

TEST(ThinLens, CircleOfConfusionHasTheLensFormulasRadius) {
  for (const float distance : kDistances) {
    const auto [camera, moments] = picture_of_point(distance, 0);
    const double expected = kLensRadius * std::abs(blur_scale(distance));
    ASSERT_LT(expected + 2 * kEmitterTangent, camera.tan_half_x) << "the blur must fit into the picture";
    const double radius = std::sqrt(2 * (moments.r2 - other_blur(camera)));  // ⟨r²⟩ = R²/2 on a uniform disk
    EXPECT_NEAR(radius, expected, 0.02 * expected) << "at distance " << distance;
    // Neither a ring nor a bell: ⟨r⁴⟩ of two uniform disks of radii c and e, folded, is c⁴/3 + c² e² + e⁴/3.
    const double c2 = expected * expected, e2 = kEmitterTangent * kEmitterTangent;
    const double fourth = c2 * c2 / 3 + c2 * e2 + e2 * e2 / 3;
    EXPECT_NEAR(moments.r4, fourth, 0.05 * fourth) << "at distance " << distance;
  }
}

TEST(ThinLens, HexagonsAndTrianglesHaveTheirSecondMoment) {
  for (const int blades : {3, 6})
    for (const float distance : kDistances) {
      const auto [camera, moments] = picture_of_point(distance, blades);
      // A regular polygon of circumradius R and n sides: ⟨r²⟩ = R² (2 + cos 2π/n) / 6.
      const double expected =
          kLensRadius * std::abs(blur_scale(distance)) * std::sqrt((2 + std::cos(2 * std::numbers::pi / blades)) / 6);
      EXPECT_NEAR(std::sqrt(moments.r2 - other_blur(camera)), expected, 0.03 * expected)
          << blades << " blades, distance " << distance;
    }
}

TEST(ThinLens, BeforeTheFocalPlaneTheApertureIsSeenUpsideDown) {
  // The triangle has a corner on +x. Behind the focal plane its image stands like the aperture, before it is turned by
  // half a turn.
  for (const float distance : kDistances) {
    const SpotMoments moments = picture_of_point(distance, 3).moments;
    // ⟨r³ cos 3φ⟩ = R³/10 for a triangle of circumradius R, scaled with the sign of d − f.
    const double expected = std::pow(kLensRadius * blur_scale(distance), 3) / 10;
    EXPECT_NEAR(moments.third, expected, 0.15 * std::abs(expected)) << "at distance " << distance;
  }
}

TEST(ThinLens, BlurKeepsTheLight) {
  const double sharp = picture_of_point(4.5f, 0, 0).moments.total;
  for (const auto& [blades, distance] : {std::pair(0, 1.7f), std::pair(0, 9.0f), std::pair(6, 9.0f)})
    EXPECT_NEAR(picture_of_point(distance, blades).moments.total, sharp, 0.05 * sharp)
        << blades << " blades, distance " << distance;
}

TEST(ThinLens, InTheFocalPlaneThePictureIsThePinholes) {
  const auto [camera, moments] = picture_of_point(kFocus, 0);
  EXPECT_NEAR(moments.r2, other_blur(camera), 0.1 * other_blur(camera));
}

TEST(Clipping, PlanesCutAtTheirDistanceAlongTheAxis) {
  SceneKit kit;
  for (const auto& [distance, radiance] : {std::pair(1.0f, 1.0f), std::pair(2.0f, 2.0f), std::pair(3.0f, 3.0f)})
    kit.quad({-5, -5, -distance}, {10, 0, 0}, {0, 10, 0}, kit.emitter(Spectrum(radiance)));
  const RenderScene scene = kit.compile();
  struct Case {
    float near_clip, far_clip, seen;
  };
  for (const float lens_radius : {0.0f, 0.05f})
    for (const Case& c : {Case{0, 0, 1}, Case{0.999f, 0, 1}, Case{1.001f, 0, 2}, Case{1.999f, 0, 2}, Case{2.001f, 0, 3},
                          Case{1.5f, 2.001f, 2}, Case{1.5f, 1.999f, 0}, Case{0, 0.999f, 0}, Case{3.001f, 0, 0}}) {
      Camera camera = pinhole({0, 0, 0}, {0, 0, -1}, 1);  // corners are √3 times as far as the middle
      camera.near_clip = c.near_clip;
      camera.far_clip = c.far_clip;
      camera.lens_radius = lens_radius;
      camera.focal_distance = 2;
      const Picture picture = render(scene, camera, square_settings(16, 4));
      for (const Spectrum& s : picture.beauty.pixels())
        ASSERT_EQ(s, Spectrum(c.seen)) << "near " << c.near_clip << ", far " << c.far_clip << ", lens " << lens_radius;
    }
}

TEST(CropWindow, IsTheSamePartOfTheWholePicture) {
  SceneKit kit;
  kit.quad({-3, -1, 3}, {6, 0, 0}, {0, 0, -6}, kit.diffuse(Spectrum(0.5f, 0.6f, 0.7f)));
  kit.sphere({0, 0, 0}, 1, kit.material(scene::GlassMaterial{Spectrum(1), Spectrum(1), 1.5f}));
  kit.quad({-1, 3, -1}, {2, 0, 0}, {0, 0, 2}, kit.emitter(Spectrum(5)));
  const RenderScene scene = kit.compile();
  Camera camera = pinhole({0, 1, 5}, {0, 0, 0}, 0.5f);
  camera.lens_radius = 0.1f;
  camera.focal_distance = 5;
  RenderSettings settings = square_settings(33, 16);
  settings.height = 29;
  const Picture whole = render(scene, camera, settings);
  for (const CropWindow window :
       {CropWindow{7, 5, 20, 13}, CropWindow{0, 0, 1, 1}, CropWindow{32, 28, 1, 1}, CropWindow{0, 20, 33, 9}}) {
    settings.crop = window;
    const Picture part = render(scene, camera, settings);
    ASSERT_EQ(part.beauty.width(), window.width);
    ASSERT_EQ(part.beauty.height(), window.height);
    Picture expected;
    expected.beauty = Image(window.width, window.height);
    for (const Channel& channel : whole.channels) expected.channels.push_back({channel.name, {}});
    for (int y = 0; y < window.height; ++y)
      for (int x = 0; x < window.width; ++x) {
        expected.beauty.at(x, y) = whole.beauty.at(window.x + x, window.y + y);
        for (std::size_t c = 0; c < whole.channels.size(); ++c)
          expected.channels[c].values.push_back(
              whole.channels[c].values[static_cast<std::size_t>(window.y + y) * 33 + window.x + x]);
      }
    EXPECT_TRUE(identical(part, expected)) << window.width << " × " << window.height;
  }
}

}  // namespace
}  // namespace etendue
