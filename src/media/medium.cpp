#include "media/medium.h"

#include <algorithm>
#include <cmath>

namespace etendue {
namespace {

/// Homogeneous media have no loops that could take for ever; this keeps products finite.
constexpr float kMaxHomogeneousExtinction = 1e12f;

/// Tracked majorants of transmittance are this much larger than they have to be: more steps, but each takes a smaller
/// share.
constexpr float kMajorantSlack = 2;

/// Below this share of light, roulette decides with probability ½ whether to go on.
constexpr float kFaint = 0.05f;

/// NaN becomes `low`.
float clamped(float x, float low, float high) {
  return x > low ? std::min(x, high) : low;
}

Spectrum clamped(const Spectrum& s, float low, float high) {
  return {clamped(s.r, low, high), clamped(s.g, low, high), clamped(s.b, low, high)};
}

/// e^(−σ t), also where t is infinite.
Spectrum beer(const Spectrum& sigma, float t) {
  const auto one = [t](float s) { return s == 0 ? 1.0f : std::exp(-s * t); };
  return {one(sigma.r), one(sigma.g), one(sigma.b)};
}

float sum(const Spectrum& s) {
  return s.r + s.g + s.b;
}

/// Probabilities of the channels in proportion to what they carry.
Spectrum shares(const Spectrum& throughput) {
  const float total = sum(throughput);
  return total > 0 ? throughput * (1 / total) : Spectrum(1.0f / 3);
}

/// The channel that u in [0, 1) chooses.
int choose_channel(const Spectrum& probability, float u) {
  if (u < probability.r) return 0;
  return u < probability.r + probability.g || probability.b == 0 ? 1 : 2;
}

Flight homogeneous_flight(const Medium& medium, const Spectrum& sigma, const Ray& ray, const Spectrum& throughput,
                          Vec2 u) {
  const Spectrum probability = shares(throughput);
  const float chosen = sigma[choose_channel(probability, u.x)];
  const float length = ray.t_max - ray.t_min;
  const float distance = chosen > 0 ? -std::log1p(-u.y) / chosen : length;
  if (!(distance < length)) {
    const Spectrum through = beer(sigma, length);
    const float pdf = sum(probability * through);
    return {std::nullopt, pdf > 0 ? through * (1 / pdf) : Spectrum(0), pdf};
  }
  const Spectrum density = sigma * beer(sigma, distance);
  const float pdf = sum(probability * density);
  const float t = ray.t_min + distance;
  return {t, pdf > 0 ? density * medium.albedo(ray.at(t)) * (1 / pdf) : Spectrum(0), 1};
}

}  // namespace

/// Loops through heterogeneous media.
class Tracking {
 public:
  Tracking(const Medium& medium, const Ray& ray, RandomStream& random) : medium_(medium), ray_(ray), random_(random) {}

  Flight flight(const Spectrum& throughput) {
    Flight flight{std::nullopt, Spectrum(1)};
    medium_.majorants_.walk(ray_, [&](float begin, float end, const ValueRange& range) {
      flight.t = collide(begin, end, range, throughput, flight.weight);
      return !flight.t;
    });
    if (flight.t) flight.weight *= medium_.albedo(ray_.at(*flight.t));
    return flight;
  }

  Spectrum transmittance() {
    Spectrum share(1);
    medium_.majorants_.walk(ray_, [&](float begin, float end, const ValueRange& range) {
      share *= std::exp(-range.min * (end - begin)) * residual(begin, end, range);
      if (share.max() < kFaint) share *= random_.next() < 0.5f ? 2.0f : 0.0f;
      return !share.is_black();
    });
    return share;
  }

 private:
  /// Extinction at a point of a cell, held to what the cell was found to hold.
  Spectrum extinction(float t, const ValueRange& range) const {
    return clamped(medium_.sigma_t_.lookup(ray_.at(t)) * medium_.scale_, range.min, range.max);
  }

  /// Where between `begin` and `end` light is scattered. `weight` becomes that of all collisions so far.
  std::optional<float> collide(float begin, float end, const ValueRange& range, const Spectrum& throughput,
                               Spectrum& weight) {
    if (range.max == 0) return std::nullopt;
    for (float s = random_.exponential() / range.max; s < end - begin; s += random_.exponential() / range.max) {
      const Spectrum real = extinction(begin + s, range) / range.max;
      const float probability = sum(shares(throughput * weight) * real);
      if (random_.next() < probability) {
        weight *= real * (1 / probability);
        return begin + s;
      }
      weight *= (Spectrum(1) - real) * (1 / (1 - probability));
    }
    return std::nullopt;
  }

  /// Unbiased estimate of the transmittance of what a cell holds beyond its minimum.
  Spectrum residual(float begin, float end, const ValueRange& range) {
    Spectrum share(1);
    const float majorant = kMajorantSlack * (range.max - range.min);
    if (!(majorant > 0)) return share;
    for (float s = random_.exponential() / majorant; s < end - begin; s += random_.exponential() / majorant)
      share *= Spectrum(1) - (extinction(begin + s, range) - Spectrum(range.min)) / majorant;
    return share;
  }

  const Medium& medium_;
  const Ray& ray_;
  RandomStream& random_;
};

Medium::Medium(Volume sigma_t, float scale, Volume albedo, const Phase& phase)
    : sigma_t_(std::move(sigma_t)),
      albedo_(std::move(albedo)),
      scale_(clamped(scale, 0, std::numeric_limits<float>::max())),
      phase_(phase) {
  max_extinction_ = kMaxHomogeneousExtinction;
  if (is_homogeneous()) return;
  max_extinction_ = std::min(max_extinction_, 1 / (kShortestFreePath * sigma_t_.bounds().diagonal()));
  majorants_ = MajorantGrid(sigma_t_, scale_, max_extinction_);
}

Spectrum Medium::extinction(const Point3& world) const {
  if (!is_homogeneous() && !majorants_.contains(world)) return Spectrum(0);
  return clamped(sigma_t_.lookup(world) * scale_, 0, max_extinction_);
}

Spectrum Medium::albedo(const Point3& world) const {
  return clamped(albedo_.lookup(world), 0, 1);
}

Flight sample_flight(const Medium& medium, const Ray& ray, const Spectrum& throughput, Vec2 u, RandomStream& random) {
  if (medium.is_homogeneous()) return homogeneous_flight(medium, medium.extinction(ray.origin), ray, throughput, u);
  return Tracking(medium, ray, random).flight(throughput);
}

Transmittance transmittance(const Medium& medium, const Ray& ray, const Spectrum& throughput, RandomStream& random) {
  if (!medium.is_homogeneous()) return {Tracking(medium, ray, random).transmittance(), 1};
  const Spectrum share = beer(medium.extinction(ray.origin), ray.t_max - ray.t_min);
  return {share, sum(shares(throughput) * share)};
}

}  // namespace etendue
