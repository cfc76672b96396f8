#include "materials/texture.h"

#include <gtest/gtest.h>

#include <limits>

#include "materials/material.h"

namespace etendue {
namespace {

/// Texel (x, y) has the colour (x, y, 1); row 0 is the top.
Image coordinates(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at(x, y) = {static_cast<float>(x), static_cast<float>(y), 1};
  return image;
}

void expect_near(const Spectrum& a, const Spectrum& b, float tolerance = 1e-5f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
}

/// The middle of a texel.
Vec2 center(const Image& image, int x, int y) {
  return {(static_cast<float>(x) + 0.5f) / static_cast<float>(image.width()),
          1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height())};
}

TEST(Texture, IsExactAtTexelCentres) {
  const Image image = coordinates(5, 3);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) expect_near(lookup_texture(image, center(image, x, y)), image.at(x, y));
}

TEST(Texture, VPointsUp) {
  const Image image = coordinates(4, 4);
  EXPECT_NEAR(lookup_texture(image, {0.5f, 0.125f}).g, 3, 1e-5);  // v near 0: the bottom row
  EXPECT_NEAR(lookup_texture(image, {0.5f, 0.875f}).g, 0, 1e-5);
}

TEST(Texture, IsLinearBetweenCentres) {
  const Image image = coordinates(5, 3);
  const Vec2 a = center(image, 1, 0), b = center(image, 2, 1);
  expect_near(lookup_texture(image, {lerp(0.25f, a.x, b.x), lerp(0.75f, a.y, b.y)}), {1.25f, 0.75f, 1});
}

TEST(Texture, RepeatsAndIsContinuousAcrossTheSeam) {
  const Image image = coordinates(5, 3);
  for (const Vec2& uv : {Vec2(0.37f, 0.81f), Vec2(0.02f, 0.97f), Vec2(0.99f, 0.01f)})
    for (const int turns : {-3, -1, 1, 7}) {
      const auto shift = static_cast<float>(turns);
      expect_near(lookup_texture(image, uv + Vec2(shift, -shift)), lookup_texture(image, uv), 2e-4f);
    }
  // Halfway between the last and the first column (row): their mean.
  EXPECT_NEAR(lookup_texture(image, {0, 0.5f}).r, 2, 1e-5);
  EXPECT_NEAR(lookup_texture(image, {1, 0.5f}).r, 2, 1e-5);
  EXPECT_NEAR(lookup_texture(image, {0.5f, 0}).g, 1, 1e-5);
}

TEST(Texture, OfOneTexelIsConstant) {
  const Image image(1, 1, {0.2f, 0.4f, 0.6f});
  for (const Vec2& uv : {Vec2(0, 0), Vec2(0.5f, 0.5f), Vec2(-3.7f, 12.1f), Vec2(1, 1)})
    expect_near(lookup_texture(image, uv), {0.2f, 0.4f, 0.6f});
}

TEST(Texture, SurvivesAnyCoordinate) {
  const Image image = coordinates(7, 4);
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  for (const float u : {0.0f, -0.0f, -1e-9f, 1.0f, 1e30f, -1e30f, kInfinity, -kInfinity, kNan})
    for (const float v : {0.0f, -1e-9f, 1.0f, 3e38f, kInfinity, kNan}) {
      const Spectrum color = lookup_texture(image, {u, v});
      EXPECT_TRUE(is_finite(color)) << u << ' ' << v;
      EXPECT_NEAR(color.b, 1, 1e-5);
    }
}

TEST(Material, DiffuseTakesItsColourFromConstantOrTexture) {
  const Textures textures = {Image(1, 1, Spectrum(0.1f)), coordinates(2, 2)};
  const Material constant{DiffuseMaterial{Spectrum(0.3f)}, {}}, textured{DiffuseMaterial{std::uint32_t{1}}, {}};
  expect_near(std::get<DiffuseBsdf>(evaluate_material(constant, {}, textures)).reflectance, Spectrum(0.3f));
  expect_near(std::get<DiffuseBsdf>(evaluate_material(textured, {0.75f, 0.25f}, textures)).reflectance, {1, 1, 1});
  EXPECT_TRUE(textured.needs_texture_coordinates());
}

TEST(Material, UniformIsItsBsdf) {
  const Material mirror{UniformMaterial{MirrorBsdf{Spectrum(0.9f)}}, {}};
  expect_near(std::get<MirrorBsdf>(evaluate_material(mirror, {}, {})).reflectance, Spectrum(0.9f));
  EXPECT_FALSE(mirror.needs_texture_coordinates());
}

}  // namespace
}  // namespace etendue
