#include "denoise/regression.h"

#include <algorithm>
#include <cmath>

namespace etendue {
namespace {

/// Of a fit: the constant and the slope along each feature.
constexpr int kUnknowns = 1 + kFeatures;

/// Keeps slopes finite along features that do not vary: their variance counts as at least this much.
constexpr float kRidge = 1e-3f;

/// A fit knows nothing of features that it has not seen: it may lead away from the neighbours' mean by this factor.
constexpr float kFarthest = 4;

/// What was fitted around each pixel, for each colour.
using Fit = std::array<std::array<Plane, kUnknowns>, 3>;

/// Everything that both filters need to weigh neighbours.
class Weights {
 public:
  Weights(const Guide& guide, const Window& window)
      : window_(window), inside_(guide.value[0].width(), guide.value[0].height()) {
    for (int c = 0; c < 3; ++c) channels_[c] = {&guide.value[c], &guide.variance[c]};
    for (int y = 0; y < inside_.height(); ++y) std::fill_n(inside_.row(y), inside_.width(), 1.0f);
  }

  /// Calls body(x, y, neighbours) for the first of each kLanes pixels of the picture, where neighbours(bandwidth,
  /// visit) calls visit(weight, x, y) for each neighbour (x, y) of that pixel, in a fixed order.
  template <typename Body>
  void for_each_pixel(const Body& body) const {
    for_each_tile(inside_.width(), inside_.height(), [&](const Tile& tile) {
      const PatchDistances distances(window_, channels_, tile);
      for (int ty = 0; ty < tile.height; ++ty)
        for (int tx = 0; tx < tile.width; tx += kLanes)
          body(tile.x + tx, tile.y + ty, [&](float bandwidth, const auto& visit) {
            const float scale = 1 / (4 * bandwidth * bandwidth);
            for (int offset = 0; offset < window_.offsets(); ++offset) {
              const int x = tile.x + tx + window_.dx(offset), y = tile.y + ty + window_.dy(offset);
              Lanes weight;
              if (weigh(distances.at(offset, tx, ty), scale, inside_.row(y) + x, weight)) visit(weight, x, y);
            }
          });
    });
  }

 private:
  /// exp(−d²/k²) as (1 − d²/4k²)⁴, which comes to an end. False if all weights are 0.
  static bool weigh(const float* distance, float scale, const float* inside, Lanes& weight) {
    for (int l = 0; l < kLanes; ++l) {
      const float linear = std::clamp(1 - distance[l] * scale, 0.0f, 1.0f) * inside[l];
      const float square = linear * linear;
      weight[l] = square * square;
    }
    float sum = 0;
    for (int l = 0; l < kLanes; ++l) sum += weight[l];
    return sum > 0;
  }

  Window window_;
  std::array<GuideChannel, 3> channels_;
  Plane inside_;  ///< 1 in the picture, 0 around it
};

/// The normal equations of kLanes fits: the matrix's upper triangle, and the right-hand side of each colour.
struct NormalEquations {
  Lanes matrix[kUnknowns][kUnknowns];
  Lanes right[3][kUnknowns];

  void add(const Lanes& weight, const Lanes (&regressor)[kUnknowns], const float* const (&color)[3]);
  /// Leaves the unknowns in `right`.
  void solve();
};

void NormalEquations::add(const Lanes& weight, const Lanes (&regressor)[kUnknowns], const float* const (&color)[3]) {
  for (int i = 0; i < kUnknowns; ++i) {
    Lanes weighted;
    for (int l = 0; l < kLanes; ++l) weighted[l] = weight[l] * regressor[i][l];
    for (int j = i; j < kUnknowns; ++j)
      for (int l = 0; l < kLanes; ++l) matrix[i][j][l] += weighted[l] * regressor[j][l];
    for (int c = 0; c < 3; ++c)
      for (int l = 0; l < kLanes; ++l) right[c][i][l] += weighted[l] * color[c][l];
  }
}

/// By Cholesky's factors UᵀU, the diagonal of U inverted.
void NormalEquations::solve() {
  for (int i = 1; i < kUnknowns; ++i)
    for (int l = 0; l < kLanes; ++l) matrix[i][i][l] += kRidge * matrix[0][0][l];
  for (int i = 0; i < kUnknowns; ++i) {
    Lanes& inverse = matrix[i][i];
    for (int l = 0; l < kLanes; ++l) inverse[l] = 1 / std::sqrt(std::max(inverse[l], 1e-12f));
    for (int j = i + 1; j < kUnknowns; ++j)
      for (int l = 0; l < kLanes; ++l) matrix[i][j][l] *= inverse[l];
    for (int c = 0; c < 3; ++c)
      for (int l = 0; l < kLanes; ++l) right[c][i][l] *= inverse[l];
    for (int k = i + 1; k < kUnknowns; ++k) {
      for (int j = k; j < kUnknowns; ++j)
        for (int l = 0; l < kLanes; ++l) matrix[k][j][l] -= matrix[i][k][l] * matrix[i][j][l];
      for (int c = 0; c < 3; ++c)
        for (int l = 0; l < kLanes; ++l) right[c][k][l] -= matrix[i][k][l] * right[c][i][l];
    }
  }
  for (int c = 0; c < 3; ++c)
    for (int i = kUnknowns - 1; i >= 0; --i) {
      for (int k = i + 1; k < kUnknowns; ++k)
        for (int l = 0; l < kLanes; ++l) right[c][i][l] -= matrix[i][k][l] * right[c][k][l];
      for (int l = 0; l < kLanes; ++l) right[c][i][l] *= matrix[i][i][l];
    }
}

void store(NormalEquations& solved, const Features& features, int x, int y, Fit& fit) {
  for (int c = 0; c < 3; ++c) {
    Lanes& constant = solved.right[c][0];  // of features from 0, not from here
    for (int f = 0; f < kFeatures; ++f) {
      const Lanes& slope = solved.right[c][f + 1];
      const float* here = features[f].row(y) + x;
      for (int l = 0; l < kLanes; ++l) constant[l] -= slope[l] * here[l];
    }
    for (int i = 0; i < kUnknowns; ++i) std::copy_n(solved.right[c][i].begin(), kLanes, fit[c][i].row(y) + x);
  }
}

std::array<Fit, kBandwidths> fit_planes(const ColorPlanes& color, const Features& features, const Weights& weights,
                                        const std::array<float, kBandwidths>& bandwidths) {
  std::array<Fit, kBandwidths> fits;
  for (Fit& fit : fits)
    for (auto& planes : fit) planes.fill(Plane(color[0].width(), color[0].height()));
  weights.for_each_pixel([&](int x, int y, const auto& neighbours) {
    for (int k = 0; k < kBandwidths; ++k) {
      NormalEquations equations{};
      Lanes regressor[kUnknowns];
      regressor[0].fill(1);
      neighbours(bandwidths[k], [&](const Lanes& weight, int qx, int qy) {
        for (int f = 0; f < kFeatures; ++f) {
          const float* there = features[f].row(qy) + qx;
          const float* here = features[f].row(y) + x;
          for (int l = 0; l < kLanes; ++l) regressor[f + 1][l] = there[l] - here[l];
        }
        equations.add(weight, regressor, {color[0].row(qy) + qx, color[1].row(qy) + qx, color[2].row(qy) + qx});
      });
      equations.solve();
      store(equations, features, x, y, fits[k]);
    }
  });
  return fits;
}

/// What the fits of one bandwidth say together.
struct Prediction {
  Lanes sum[3][kUnknowns];
  Lanes mean[3];  ///< of the neighbours' colours
  Lanes total;

  void add(const Lanes& weight, const Fit& fit, const ColorPlanes& color, int x, int y);
  void store(const Features& features, int x, int y, ColorPlanes& result) const;
};

void Prediction::add(const Lanes& weight, const Fit& fit, const ColorPlanes& color, int x, int y) {
  for (int l = 0; l < kLanes; ++l) total[l] += weight[l];
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < kUnknowns; ++i) {
      const float* there = fit[c][i].row(y) + x;
      for (int l = 0; l < kLanes; ++l) sum[c][i][l] += weight[l] * there[l];
    }
    const float* there = color[c].row(y) + x;
    for (int l = 0; l < kLanes; ++l) mean[c][l] += weight[l] * there[l];
  }
}

void Prediction::store(const Features& features, int x, int y, ColorPlanes& result) const {
  for (int c = 0; c < 3; ++c) {
    Lanes value = sum[c][0];
    for (int f = 0; f < kFeatures; ++f) {
      const float* here = features[f].row(y) + x;
      for (int l = 0; l < kLanes; ++l) value[l] += sum[c][f + 1][l] * here[l];
    }
    for (int l = 0; l < kLanes; ++l) {
      const float low = mean[c][l] / kFarthest, high = mean[c][l] * kFarthest;
      result[c].row(y)[x + l] = std::max(std::min(value[l], high), low) / total[l];
    }
  }
}

void mirror(ColorPlanes& planes) {
  for (Plane& plane : planes) plane.mirror();
}

}  // namespace

ColorPlanes weighted_mean(const ColorPlanes& color, const Guide& guide, const Window& window, float bandwidth) {
  ColorPlanes result;
  result.fill(Plane(color[0].width(), color[0].height()));
  const Weights weights(guide, window);
  weights.for_each_pixel([&](int x, int y, const auto& neighbours) {
    Lanes sum[3] = {}, total = {};
    neighbours(bandwidth, [&](const Lanes& weight, int qx, int qy) {
      for (int l = 0; l < kLanes; ++l) total[l] += weight[l];
      for (int c = 0; c < 3; ++c) {
        const float* there = color[c].row(qy) + qx;
        for (int l = 0; l < kLanes; ++l) sum[c][l] += weight[l] * there[l];
      }
    });
    for (int c = 0; c < 3; ++c)
      for (int l = 0; l < kLanes; ++l) result[c].row(y)[x + l] = sum[c][l] / total[l];
  });
  mirror(result);
  return result;
}

std::array<ColorPlanes, kBandwidths> regressions(const ColorPlanes& color, const Features& features, const Guide& guide,
                                                 const Window& window,
                                                 const std::array<float, kBandwidths>& bandwidths) {
  const Weights weights(guide, window);
  const std::array<Fit, kBandwidths> fits = fit_planes(color, features, weights, bandwidths);
  std::array<ColorPlanes, kBandwidths> results;
  for (ColorPlanes& result : results) result.fill(Plane(color[0].width(), color[0].height()));
  weights.for_each_pixel([&](int x, int y, const auto& neighbours) {
    for (int k = 0; k < kBandwidths; ++k) {
      Prediction prediction{};
      neighbours(bandwidths[k],
                 [&](const Lanes& weight, int qx, int qy) { prediction.add(weight, fits[k], color, qx, qy); });
      prediction.store(features, x, y, results[k]);
    }
  });
  for (ColorPlanes& result : results) mirror(result);
  return results;
}

}  // namespace etendue
