#include "sampling/cumulative_rows.h"

#include <cstring>

namespace etendue {
namespace {

using Float4 [[gnu::vector_size(16)]] = float;

/// How many of 16 values are at most u.
int count_passed(const float* values, float u) {
  const auto four = [&](int first) {
    Float4 v;
    std::memcpy(&v, values + first, sizeof(v));
    return v <= u;  // −1 where true
  };
  const auto passed = four(0) + four(4) + four(8) + four(12);
  return -(passed[0] + passed[1] + passed[2] + passed[3]);
}

}  // namespace

CumulativeRows::CumulativeRows(int rows, int columns) {
  constexpr float kNeverReached = 2;
  for (std::size_t count = columns;; count = levels_.back().stride) {
    const std::size_t stride = (count + kFanOut - 1) / kFanOut;
    Block padding;
    padding.fill(kNeverReached);
    levels_.push_back({stride, std::vector<Block>(stride * rows, padding)});
    if (stride == 1) break;
  }
}

void CumulativeRows::set_row(int row, std::span<const float> cdf) {
  for (std::size_t l = 0, step = 1; l < levels_.size(); ++l, step *= kFanOut) {
    Level& level = levels_[l];
    for (std::size_t i = 0; i * step < cdf.size(); ++i)
      level.blocks[static_cast<std::size_t>(row) * level.stride + i / kFanOut][i % kFanOut] =
          cdf[std::min((i + 1) * step, cdf.size()) - 1];
  }
}

CumulativeRows::Interval CumulativeRows::find(int row, float u) const {
  Interval found;
  find(std::span(&row, 1), std::span(&u, 1), std::span(&found, 1));
  return found;
}

void CumulativeRows::find(std::span<const int> rows, std::span<const float> u, std::span<Interval> found) const {
  std::ranges::fill(found, Interval{0, 0, 1});
  for (std::size_t l = levels_.size(); l-- > 0;) {
    const Block* blocks = levels_[l].blocks.data();
    const auto stride = static_cast<std::ptrdiff_t>(levels_[l].stride);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Block& block = blocks[rows[i] * stride + found[i].index];
      const int passed = count_passed(block.data(), u[i]);
      if (passed > 0) found[i].begin = block[passed - 1];
      found[i].end = block[passed];
      found[i].index = found[i].index * kFanOut + passed;
    }
  }
}

}  // namespace etendue
