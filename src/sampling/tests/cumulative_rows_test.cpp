#include "sampling/cumulative_rows.h"

#include <gtest/gtest.h>

#include "testing/random.h"

namespace etendue {
namespace {

/// However many levels the search has, it finds what a bisection finds.
TEST(CumulativeRows, FindTheFirstValueThatExceeds) {
  Random random(1);
  for (const int columns : {1, 2, 15, 16, 17, 255, 256, 257, 4097}) {
    CumulativeRows rows(3, columns);
    std::vector<std::vector<float>> cdfs;
    for (int row = 0; row < 3; ++row) {
      std::vector<float> cdf(columns);
      for (float& value : cdf) value = random.value() < 0.3f ? 0.5f : random.value();  // some have no width
      std::ranges::sort(cdf);
      cdf.back() = 1;
      rows.set_row(row, cdf);
      cdfs.push_back(cdf);
    }
    for (int i = 0; i < 3000; ++i) {
      const int row = i % 3;
      const std::vector<float>& cdf = cdfs[row];
      const float u = i < 100 ? std::min(cdf[i * columns / 100], kOneMinusEpsilon) : random.value();  // on a step, too
      const auto expected = static_cast<int>(std::ranges::upper_bound(cdf, u) - cdf.begin());
      const CumulativeRows::Interval found = rows.find(row, u);
      ASSERT_EQ(found.index, expected) << columns << ' ' << u;
      EXPECT_EQ(found.begin, expected > 0 ? cdf[expected - 1] : 0.0f);
      EXPECT_EQ(found.end, cdf[expected]);
      EXPECT_EQ(rows.at(row, expected), cdf[expected]);
    }
  }
}

}  // namespace
}  // namespace etendue
