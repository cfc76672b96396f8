#include "image/false_color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace etendue {
namespace {

double lightness(const Spectrum& c) {
  const double y = c.luminance();
  return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389 / 27;
}

TEST(RateColor, GoesFromBlueOverGreenToRed) {
  EXPECT_EQ(rate_color(0), Spectrum(0, 0, 1));
  EXPECT_EQ(rate_color(0.5f), Spectrum(0, 1, 0));
  EXPECT_EQ(rate_color(1), Spectrum(1, 0, 0));
  EXPECT_GT(rate_color(0.3f).g, rate_color(0.2f).g);
  EXPECT_GT(rate_color(0.8f).r, rate_color(0.7f).r);
}

TEST(FalseColor, WhatIsOutOfRangeIsClamped) {
  for (const auto color : {rate_color, heat_color}) {
    EXPECT_EQ(color(-5), color(0));
    EXPECT_EQ(color(7), color(1));
    EXPECT_EQ(color(std::numeric_limits<float>::infinity()), color(1));
    EXPECT_EQ(color(std::numeric_limits<float>::quiet_NaN()), color(0));
  }
}

TEST(HeatColor, LightnessGrowsEvenly) {
  EXPECT_EQ(heat_color(0), Spectrum(0));
  EXPECT_GT(lightness(heat_color(1)), 95);
  for (int i = 0; i < 50; ++i) {
    const float t = static_cast<float>(i) / 50.0f;
    EXPECT_NEAR(lightness(heat_color(t)), 97.0 * t, 4) << t;
    EXPECT_GT(lightness(heat_color(t + 0.02f)), lightness(heat_color(t)));
  }
}

TEST(HeatMap, KeepsTheRows) {
  const std::vector<float> values = {0, 0.25f, 0.5f, 0.75f, 1, 2};
  const Image map = heat_map(values, 3, 2);
  EXPECT_EQ(map.at(0, 0), heat_color(0));
  EXPECT_EQ(map.at(2, 0), heat_color(0.5f));
  EXPECT_EQ(map.at(0, 1), heat_color(0.75f));
  EXPECT_EQ(map.at(2, 1), heat_color(1));
}

}  // namespace
}  // namespace etendue
