#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "sampling/sampler.h"
#include "scene/scene.h"

namespace etendue {

enum class IntegratorKind {
  automatic,   ///< all light, to max_depth bounces, by the techniques that suit the scene
  path,        ///< the same by plain path tracing
  direct,      ///< emitted light and light that bounced once, by sampling the lights
  hemisphere,  ///< all light, but direct light by uniform directions of the hemisphere: point-like lights are not seen
  normals,     ///< shading normals, (n + 1) / 2
  albedo,      ///< reflectance of what is seen
  ao,          ///< ambient occlusion: share of the cosine-weighted hemisphere open to a quarter of the scene's diagonal
};

/// Whether to use a technique that pays in some scenes only; `automatic` is off for IntegratorKind::path.
enum class Use { automatic, off, on };

/// Rectangle of pixels, (x, y) its upper left corner.
struct CropWindow {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The teaching renderer's criterion: after every `batch` samples a pixel stops once 1.96 σ/√n ≤ tolerance · mean.
struct AdaptiveSampling {
  int batch = 32;
  float tolerance = 0.05f;
};

inline constexpr int kUnlimitedDepth = std::numeric_limits<int>::max();

/// What picture to make of a scene and how well.
struct RenderSettings {
  int width = 800, height = 600;       ///< of the whole picture, in pixels
  std::optional<CropWindow> crop;      ///< render only this part; the result has its size
  int samples_per_pixel = 64;          ///< the most a pixel gets
  int light_samples = 0;               ///< per light and vertex (point-like lights: 1); 0: of chosen lights
  int max_depth = kUnlimitedDepth;     ///< bounces: 0 emitted light only, 1 direct light, …
  bool null_counts_as_bounce = false;  ///< whether light that passes a mask, null boundary or thin pane has bounced
  bool hide_emitters = false;          ///< camera rays see neither lights nor their shapes
  IntegratorKind integrator = IntegratorKind::automatic;
  Use photons = Use::automatic;    ///< for light that comes by way of mirrors and smooth glass
  Use reuse = Use::automatic;      ///< neighbouring pixels share their paths
  Use cache = Use::automatic;      ///< light between diffuse surfaces is looked up
  Use airlight = Use::automatic;   ///< point-like lights are sampled along whole segments in homogeneous media
  Use splitting = Use::automatic;  ///< several lights at early vertices, both ways at glass, more rays by glass alone
  SamplerKind sampler = SamplerKind::sobol;
  scene::ReconstructionFilter filter;  ///< how samples near a pixel count towards it
  std::uint64_t seed = 0;
  std::optional<AdaptiveSampling> adaptive;
  std::optional<float> clamp;    ///< luminance that no sample exceeds; biased
  bool doubts_outliers = false;  ///< lone bright samples count for less (Cascades); biased, the less the more samples
  bool for_denoising = false;    ///< make the samples two independent halves, and keep both
  int tile_size = 16;            ///< pixels along the side of a unit of work; changes no pixel
  /// Bytes that photons and what is recorded for lookups may take; where there are many, fewer are made.
  std::uint64_t memory_limit = std::uint64_t{512} << 20;
};

inline constexpr std::uint64_t kLeastMemory = std::uint64_t{1} << 20;  ///< for memory_limit

}  // namespace etendue
