#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "math/vec.h"

namespace etendue {

/// Rows of cumulative probabilities, each of which is inverted by a search that divides by 16: one cache line and no
/// branch a step. Over each block of 16 values stands its last one in the level above.
class CumulativeRows {
 public:
  CumulativeRows() = default;
  CumulativeRows(int rows, int columns);

  /// `cdf`: `columns` values that do not fall; the last is 1.
  void set_row(int row, std::span<const float> cdf);
  float at(int row, int column) const {
    return levels_[0].blocks[static_cast<std::size_t>(row) * levels_[0].stride + column / kFanOut][column % kFanOut];
  }

  struct Interval {
    int index;                                   ///< of the first value that exceeds u
    float begin, end;                            ///< the value before it, or 0, and itself
    float width() const { return end - begin; }  ///< its probability
    /// Position of u within the interval, in [0, 1).
    float remapped(float u) const { return std::min((u - begin) / width(), kOneMinusEpsilon); }
  };
  /// The interval of `row` that holds u, in [0, 1).
  Interval find(int row, float u) const;
  /// The same for many numbers, found[i] for u[i] in rows[i], level by level: they wait for memory together.
  void find(std::span<const int> rows, std::span<const float> u, std::span<Interval> found) const;

 private:
  static constexpr int kFanOut = 16;
  struct alignas(64) Block : std::array<float, kFanOut> {};
  struct Level {
    std::size_t stride;  ///< blocks in a row
    std::vector<Block> blocks;
  };
  std::vector<Level> levels_;  ///< from the values themselves to the one with one block a row
};

}  // namespace etendue
