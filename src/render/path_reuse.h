#pragma once

#include <cstdint>
#include <span>

#include "math/spectrum.h"
#include "render/film.h"
#include "render/vertex.h"

namespace etendue {

/// What a path leaves for its neighbours to use: its first vertex that is more than delta lobes, and the light that it
/// found leaving the next one, where that is the same into all directions.
struct SharedPath {
  bool has_first = false;
  Vertex first;         ///< if it has one: from where neighbours' second vertices may be seen
  Spectrum throughput;  ///< from the camera to there
  int depth = 0;        ///< bounces before it

  bool has_second = false;
  Spectrum f_cos;       ///< of the first vertex' BSDF, towards the second
  float pdf = 0;        ///< with which that direction was chosen, per solid angle
  SurfaceHit second;    ///< Lambertian
  Spectrum radiance{};  ///< estimate of what it scatters towards the first vertex, and to all others on that side
};

/// Adds the light of all second vertices to the samples of all paths, one of each of several pixels, that can see them:
/// the paths of neighbouring pixels become techniques for one integral, combined by the balance heuristic (Bekaert,
/// Sbert and Halton 2002, "Accelerating Path Tracing by Re-Using Paths"; weights of Veach 1997, eq. 9.8). Visibility is
/// tested both for what a path gains and for what it would have sampled, so the result is unbiased. Returns the number
/// of rays traced. At most Geometry::kBatch paths.
std::uint64_t share_paths(const Geometry& geometry, std::span<const SharedPath* const> paths,
                          std::span<PixelSample* const> samples);

}  // namespace etendue
