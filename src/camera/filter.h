#pragma once

#include <vector>

#include "math/vec.h"
#include "scene/scene.h"

namespace etendue {

/// How samples near a pixel count towards it, by sampling the filter: each sample belongs to one pixel, lies about its
/// centre with the density of |filter|, and carries the filter's sign (Ernst, Stamminger and Greiner 2006, "Filter
/// Importance Sampling"). Pixels stay independent of each other, and those at the border look beyond it as all others
/// do. Separable: f(x) f(y), each with integral 1.
class PixelFilter {
 public:
  /// Lengths are brought into reason: the radius into (0, 16] pixels.
  explicit PixelFilter(const scene::ReconstructionFilter& filter = {});

  struct Sample {
    Vec2 offset;   ///< from the pixel's centre, in pixels
    float weight;  ///< filter / density: 1 for the box, below 0 in negative lobes; its mean is 1
  };
  Sample sample(Vec2 u) const;

  bool is_box() const { return cells_.empty(); }
  bool has_negative_lobes() const;
  float radius() const { return radius_; }
  /// The filter in one dimension, before its integral is made 1.
  static float value(const scene::ReconstructionFilter& filter, float x);

 private:
  /// An interval of equal |filter| integral; the density is constant within.
  struct Cell {
    float begin, width;
    float weight;
  };
  float sample_axis(float u, float& weight) const;

  float radius_;             ///< of the box: half its width
  std::vector<Cell> cells_;  ///< of equal probability, from left to right; empty: a box
};

}  // namespace etendue
