#pragma once

#include <optional>

#include "math/ray.h"
#include "math/spectrum.h"
#include "media/majorants.h"
#include "media/phase.h"
#include "sampling/random_stream.h"
#include "volumes/volume.h"

namespace etendue {

/// A participating medium. Extinction is σt in m⁻¹, albedo the share of it that is scattering.
class Medium {
 public:
  /// Extinction is sigma_t · scale: the same everywhere, to infinity, if the volume is constant, else nothing outside
  /// its bounds. Values that no medium can have are brought to what is near: extinction into [0, max_extinction()],
  /// albedo into [0, 1].
  Medium(Volume sigma_t, float scale, Volume albedo, const Phase& phase);

  bool is_homogeneous() const { return sigma_t_.is_constant(); }
  Spectrum extinction(const Point3& world) const;
  Spectrum albedo(const Point3& world) const;
  const Phase& phase() const { return phase_; }

  /// Light that has come this small a share of a heterogeneous medium's diagonal without being scattered is not told
  /// from light that meets a surface: denser media are none other, but would take for ever.
  static constexpr float kShortestFreePath = 1e-5f;
  float max_extinction() const { return max_extinction_; }

 private:
  friend class Tracking;

  Volume sigma_t_, albedo_;
  float scale_, max_extinction_;
  Phase phase_;
  MajorantGrid majorants_;  ///< of heterogeneous media
};

/// Where light that comes along a ray, against its direction, was scattered last.
struct Flight {
  std::optional<float> t;  ///< nothing: not before the ray's end
  Spectrum
      weight;  ///< transmittance · extinction · albedo (without scattering: transmittance) / density of this flight
  float survival = 1;  ///< as Transmittance has it
};

/// Share of light that gets along a ray.
struct Transmittance {
  Spectrum share{1};   ///< unbiased estimate; exact in homogeneous media
  float survival = 1;  ///< probability that sample_flight() with the same throughput gets there, if it is known: 1 in
                       ///< heterogeneous media
};

/// Chooses where a ray between its t_min and t_max is scattered. `throughput` is that of the path so far: distances
/// follow its channels in proportion, so that no channel's weight grows beyond what all of them have together.
/// Homogeneous media: exponential distances by `u`. Heterogeneous ones: delta tracking with collisions that know the
/// path's history (Kutz et al. 2017, section 4.2) by `random`.
Flight sample_flight(const Medium& medium, const Ray& ray, const Spectrum& throughput, Vec2 u, RandomStream& random);

/// Homogeneous media: Beer's law. Heterogeneous ones: within each cell of the majorants its least extinction exactly,
/// the rest by residual ratio tracking (Novák et al. 2014).
Transmittance transmittance(const Medium& medium, const Ray& ray, const Spectrum& throughput, RandomStream& random);

}  // namespace etendue
