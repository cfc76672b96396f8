#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string_view>

#include "render/camera_rays.h"

namespace etendue {

/// Neighbouring pixels.
struct PixelBlock {
  int x = 0, y = 0, width = 1, height = 1;
  int size() const { return width * height; }
  static constexpr int kMost = 16;  ///< pixels
};

/// Estimates the radiance that arrives at a pixel. All threads share one; between calls to prepare() it does not
/// change.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// What the picture's expectation is, for people.
  virtual std::string_view promise() const { return "unbiased"; }

  /// How many samples of a pixel one prepare() serves; a multiple of Geometry::kBatch.
  virtual std::uint32_t generation_size() const { return std::numeric_limits<std::uint32_t>::max(); }

  /// To be called before samples generation · generation_size() and the next ones are estimated, by one thread. Returns
  /// the number of rays traced.
  virtual std::uint64_t prepare([[maybe_unused]] std::uint32_t generation) { return 0; }

  /// Pixels along the side of the blocks that are estimated together.
  virtual int block_side() const { return 1; }

  /// Fills samples[p · count + i] with sample first + i of the block's pixel p, row by row; at most Geometry::kBatch
  /// samples a pixel. Returns the number of rays traced. The result depends on nothing but its arguments and the
  /// generation that was prepared, to which all samples belong.
  virtual std::uint64_t estimate(const PixelBlock& block, std::uint32_t first, int count,
                                 std::span<PixelSample> samples) const = 0;
};

/// The integrator that `settings` ask for. The scene must outlive it.
std::unique_ptr<Integrator> make_integrator(const RenderScene::Data& scene, const Camera& camera,
                                            const RenderSettings& settings);

}  // namespace etendue
