#include "materials/texture.h"

#include <gtest/gtest.h>

#include <limits>

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

Spectrum lookup_texture(const Image& image, Vec2 uv) {
  return BitmapTexture{Texels(image)}.lookup(uv);
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

TEST(Texture, MirrorsAndClamps) {
  BitmapTexture texture{Texels(coordinates(4, 1))};
  texture.wrap = TexelWrap::mirror;
  for (const float u : {0.1f, 0.4f, 0.9f})
    for (const float other : {-u, 2 - u, u + 2, u - 4})
      expect_near(texture.lookup({other, 0.5f}), texture.lookup({u, 0.5f}), 1e-4f);
  texture.wrap = TexelWrap::clamp;
  EXPECT_NEAR(texture.lookup({-5, 0.5f}).r, 0, 1e-6);
  EXPECT_NEAR(texture.lookup({7, 0.5f}).r, 3, 1e-6);
  EXPECT_NEAR(texture.lookup({0.01f, 0.5f}).r, 0, 1e-6);
}

TEST(Texture, NearestIsTheTexelsOwnColour) {
  BitmapTexture texture{Texels(coordinates(4, 3))};
  texture.filter = TexelFilter::nearest;
  expect_near(texture.lookup({0.3f, 0.4f}), {1, 1, 1});
  expect_near(texture.lookup({0.99f, 0.01f}), {3, 2, 1});
}

TEST(Texture, GradientIsThatOfTheLookup) {
  Image image(8, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) image.at(x, y) = Spectrum(0.5f + 0.4f * std::sin(static_cast<float>(3 * x + 5 * y)));
  const Textures textures = {
      BitmapTexture{Texels(image), TexelFilter::bilinear, TexelWrap::repeat, {{2, 0.5f}, {-0.25f, 3}, {0.1f, 0.2f}}}};
  constexpr float kStep = 1e-4f;
  for (const Vec2& uv : {Vec2(0.13f, 0.57f), Vec2(0.71f, 0.22f), Vec2(0.4f, 0.9f)}) {
    const auto at = [&](float u, float v) {
      return evaluate_texture(textures, 0, TexturePoint{{u, v}, Point3(0), nullptr, {}}).luminance();
    };
    const Vec2 gradient = luminance_gradient(textures, 0, TexturePoint{uv, Point3(0), nullptr, {}});
    EXPECT_NEAR(gradient.x, (at(uv.x + kStep, uv.y) - at(uv.x - kStep, uv.y)) / (2 * kStep),
                0.02f * std::abs(gradient.x) + 0.02f);
    EXPECT_NEAR(gradient.y, (at(uv.x, uv.y + kStep) - at(uv.x, uv.y - kStep)) / (2 * kStep),
                0.02f * std::abs(gradient.y) + 0.02f);
  }
}

TEST(Texture, CheckerboardHasFourFields) {
  const Textures textures = {CheckerboardTexture{Spectrum(1), Spectrum(0), {}}};
  const auto at = [&](float u, float v) {
    return evaluate_texture(textures, 0, TexturePoint{{u, v}, Point3(0), nullptr, {}}).r;
  };
  EXPECT_EQ(at(0.25f, 0.25f), 1);
  EXPECT_EQ(at(0.75f, 0.25f), 0);
  EXPECT_EQ(at(0.25f, -0.25f), 0);
  EXPECT_EQ(at(0.75f, 1.75f), 1);
}

}  // namespace
}  // namespace etendue
