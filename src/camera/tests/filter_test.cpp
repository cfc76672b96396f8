#include "camera/filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace etendue {
namespace {

using scene::FilterKind;
using scene::ReconstructionFilter;

const ReconstructionFilter kAll[] = {
    {FilterKind::box, 0.5f},      {FilterKind::box, 1.25f},  {FilterKind::tent, 1},
    {FilterKind::gaussian, 2},    {FilterKind::mitchell, 2}, {FilterKind::mitchell, 2, 0, 0.75f},
    {FilterKind::catmull_rom, 2}, {FilterKind::lanczos, 3},  {FilterKind::lanczos, 2}};

/// ∫ f(x) g(x) dx / ∫ f(x) dx by Simpson's rule.
double filtered(const ReconstructionFilter& filter, double (*g)(double)) {
  const int n = 20000;
  double sum = 0, norm = 0;
  for (int i = 0; i <= n; ++i) {
    const double x = filter.radius * (2.0 * i / n - 1), w = i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2;
    const double f = PixelFilter::value(filter, static_cast<float>(x));
    sum += w * f * g(x);
    norm += w * f;
  }
  return sum / norm;
}

/// The same by the filter's samples, on a grid of u.
double sampled(const PixelFilter& filter, double (*g)(double)) {
  const int n = 1 << 16;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const auto s = filter.sample({(static_cast<float>(i) + 0.5f) / n, 0.5f});
    const auto across = filter.sample({0.5f, 0.5f});  // the weight of the other axis
    sum += s.weight / std::sqrt(std::abs(across.weight)) * g(s.offset.x);
  }
  return sum / n;
}

TEST(PixelFilter, SamplesHaveTheFiltersMoments) {
  for (const ReconstructionFilter& filter : kAll) {
    const PixelFilter sampler(filter);
    for (auto* g : {+[](double) { return 1.0; }, +[](double x) { return x; }, +[](double x) { return x * x; },
                    +[](double x) { return std::cos(4 * x); }, +[](double x) { return x > 0.3 ? 1.0 : 0.0; }})
      EXPECT_NEAR(sampled(sampler, g), filtered(filter, g), 2e-3)
          << static_cast<int>(filter.kind) << " radius " << filter.radius;
  }
}

TEST(PixelFilter, PositiveFiltersWeighEverySampleAlike) {
  for (const ReconstructionFilter& filter : kAll) {
    const PixelFilter sampler(filter);
    float least = 10, most = -10;
    for (int i = 0; i < 4096; ++i) {
      const float w = sampler.sample({(static_cast<float>(i) + 0.5f) / 4096, 0.5f}).weight;
      least = std::min(least, w);
      most = std::max(most, w);
    }
    const bool positive =
        filter.kind == FilterKind::box || filter.kind == FilterKind::tent || filter.kind == FilterKind::gaussian;
    if (positive)
      EXPECT_LT(most - least, 1e-3f) << static_cast<int>(filter.kind);
    else
      EXPECT_LT(least, 0) << static_cast<int>(filter.kind);
  }
}

TEST(PixelFilter, ReachesNoFartherThanItsRadius) {
  for (const ReconstructionFilter& filter : kAll) {
    const PixelFilter sampler(filter);
    for (const float u : {0.0f, 0.25f, 0.999999f})
      EXPECT_LE(std::abs(sampler.sample({u, u}).offset.x), filter.radius * 1.00001f);
  }
  EXPECT_FLOAT_EQ(PixelFilter(ReconstructionFilter{FilterKind::box, -1}).radius(), 0.5f);
  EXPECT_FLOAT_EQ(PixelFilter(ReconstructionFilter{FilterKind::gaussian, 1e9f}).radius(), 16);
}

}  // namespace
}  // namespace etendue
