#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "camera/camera.h"
#include "denoise/denoise.h"
#include "image/image.h"
#include "render/render_scene.h"
#include "render/settings.h"

namespace etendue {

/// How far a session is. All counts are of the picture, not of a pass.
struct RenderProgress {
  std::uint64_t samples_done = 0;     ///< camera paths so far
  std::uint64_t samples_total = 0;    ///< of a render that runs to its end; pixels that stop early count as finished
  std::uint64_t rays = 0;             ///< all rays traced: camera, bounce and shadow
  std::uint64_t invalid_samples = 0;  ///< samples that were NaN, infinite or negative and count as black
  std::size_t unsampled_pixels = 0;   ///< as of the last pass: black, because it was stopped before their first sample
  std::string first_invalid;          ///< where the first of them fell: pixel, sample
  double render_seconds = 0;          ///< wall time inside finished passes
  double noise = 0;  ///< relative standard error as of the last pass: mean over pixels of σ/√n / (mean + 0.01)
};

/// One picture in the making: what the command line, a viewer or a script drives. Passes are cheap to start; the
/// picture is the same to the bit for any number of threads, any tile size and any split into passes.
class RenderSession {
 public:
  RenderSession(RenderScene scene, const Camera& camera, const RenderSettings& settings);
  ~RenderSession();
  RenderSession(RenderSession&&) noexcept;
  RenderSession& operator=(RenderSession&&) noexcept;

  /// Adds `samples` samples, rounded up to whole batches, to every unfinished pixel (0: a number that keeps passes near
  /// half a second). Returns early, with every pixel in a valid state, when a stop is asked for.
  void render_pass(const std::stop_token& stop, int samples = 0);

  /// What the picture's expectation is: "unbiased", or what is not and why, in a few words.
  std::string estimator() const;

  bool finished() const;  ///< every pixel has all samples it is to get
  /// May be called from another thread while a pass runs (then rays and samples are approximate).
  RenderProgress progress() const;

  /// The picture so far with the channels albedo.{R,G,B}, normal.{X,Y,Z}, depth.Z, samples.N and variance.{R,G,B}
  /// (variance of one sample; divided by samples.N it is that of the mean). Not while a pass runs.
  Picture snapshot() const;

  /// The beauty alone, cheaper, for previews. Not while a pass runs.
  Image beauty() const;

  /// The picture so far as a denoiser needs it. Nothing unless the settings ask for it, and every pixel has
  /// kMinimumToDenoise samples. Not while a pass runs.
  std::optional<NoisyPicture> noisy_picture() const;

  /// Samples each pixel took, blue (few) to red (many), relative to samples_per_pixel.
  Image sample_rate_picture() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace etendue
