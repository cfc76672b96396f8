#include "render/caustic_photons.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "render/caustic_targets.h"
#include "render/direct_light.h"
#include "render/generations.h"
#include "render/pixel_width.h"
#include "sampling/sampler.h"

namespace etendue {
namespace {

constexpr int kMostBounces = SpecularChain::kMostBounces;
/// One photon is emitted for so many samples of pixels, as far as memory allows.
constexpr std::uint64_t kSamplesPerPhoton = std::uint64_t{2} * Geometry::kBatch;
/// More are, up to so many times, where fewer than one arrives of each.
constexpr double kMostMore = 4;
constexpr std::uint32_t kChunk = 1024;
/// Of the first generation, in pixels as wide as they are at most of the surfaces that the camera sees.
constexpr float kRadiusInPixels = 0.5f;
/// r² ∝ (generation + 1)^−⅓ (Knaus and Zwicker 2011, eq. 10 with α = ⅔, as a power).
constexpr float kShrinking = -1.0f / 6;
/// Instead of a generation: photons that only show where the others will be, as many as this many shares.
constexpr std::uint32_t kPilot = 0xffff'ffffu;
constexpr std::uint32_t kPilotShares = 2;
/// Photons on surfaces that turn away by more than this cosine are not those of this surface.
constexpr float kSameSurface = 0.7f;
/// Share of the photons on a diffuse surface that go on, towards mirrors and glass.
constexpr float kScattered = 0.5f;
constexpr std::uint64_t kMostSurfaces = 128;  ///< that a photon meets
/// In place of a pixel's row, which no picture reaches: photons' random numbers.
constexpr std::uint32_t kPhotonRow = 0xffff'fff0u;

/// Dimensions of a photon's random numbers.
enum : std::uint64_t {
  kWhich,
  kPosition,
  kDirection,
  kTarget,
  kBounce,
  kKeep = kBounce + kMostSurfaces,
  kScatter = kKeep + kMostSurfaces
};

}  // namespace

float etendue_ratio(const Vertex& vertex, const Vec3& wi) {
  const Vec3 &ng = vertex.surface.geometric_normal, &ns = vertex.scattering.normal();
  const float before = dot(vertex.wo, ng) * dot(wi, ns), after = dot(wi, ng) * dot(vertex.wo, ns);
  return before != 0 ? std::abs(after / before) : 1.0f;
}

struct CausticPhotons::Arrived {
  std::vector<Photon> photons;
  std::uint64_t rays = 0;
};

CausticPhotons::CausticPhotons(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings,
                               std::uint32_t generation_size)
    : scene_(scene), sampler_(settings.sampler), seed_(settings.seed), light_samples_(settings.light_samples) {
  if (!scene.media.empty()) return;
  aim_ = LightAim(scene.lights, specular_targets(scene), scene.geometry.bounds());
  if (!aim_.possible()) return;
  first_radius_ = kRadiusInPixels * usual_pixel_width(scene, camera, settings);
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  // One share is made at a time.
  constexpr std::uint64_t kBytesToMake = sizeof(Photon) + PhotonMaps::kBytesToMake;
  constexpr std::uint64_t kBytesPerPhoton =
      PhotonSpread::kBytesPerPhoton + PhotonMaps::kBytesPerPhoton + (kBytesToMake + kShares - 1) / kShares;
  most_kept_ = (photon_memory(settings) - kShares * PhotonMaps::kFewestBytes) / kBytesPerPhoton / kShares;
  emitted_ = static_cast<std::uint32_t>(std::min(pixels * generation_size / kSamplesPerPhoton / kShares, most_kept_));
}

/// Where several arrive of each one emitted, fewer are.
CausticPhotons::Arrived CausticPhotons::trace_pilot() {
  Arrived pilot = trace_range(kPilot, 0, emitted_);
  if (pilot.photons.size() > most_kept_) {
    emitted_ = static_cast<std::uint32_t>(std::max(emitted_ * most_kept_ / pilot.photons.size(), std::uint64_t{1}));
    pilot = trace_range(kPilot, 0, emitted_);
  }
  const Arrived rest = trace_range(kPilot, emitted_, (kPilotShares - 1) * emitted_);
  pilot.photons.insert(pilot.photons.end(), rest.photons.begin(), rest.photons.end());
  pilot.rays += rest.rays;
  return pilot;
}

/// How many photons of each share to emit if so many of `emitted` arrive: more, where fewer than one of each does.
std::uint32_t CausticPhotons::worthwhile(std::uint64_t emitted, std::uint64_t arrived) const {
  const double rate = static_cast<double>(arrived) / static_cast<double>(emitted);
  const double more = std::clamp(1 / std::max(rate, 1e-3), 1.0, kMostMore);
  const double most = static_cast<double>(most_kept_) / std::max(rate, 1.0);
  return static_cast<std::uint32_t>(std::max(std::min(emitted_ * more, most), 1.0));
}

CausticPhotons::Arrived CausticPhotons::trace_range(std::uint32_t generation, std::uint32_t begin,
                                                    std::uint32_t count) const {
  const std::size_t chunks = (count + kChunk - 1) / kChunk;
  std::vector<Arrived> parts(chunks);
  parallel_for(chunks, 1, [&](std::size_t first_chunk, std::size_t end_chunk) {
    for (std::size_t chunk = first_chunk; chunk < end_chunk; ++chunk) {
      const auto first = static_cast<std::uint32_t>(chunk) * kChunk;
      for (std::uint32_t i = first; i < std::min(first + kChunk, count); ++i)
        parts[chunk].rays += trace_one(generation, begin + i, parts[chunk].photons);
    }
  });
  Arrived all;
  std::size_t size = 0;
  for (const Arrived& part : parts) size += part.photons.size();
  all.photons.reserve(size);
  for (const Arrived& part : parts) {
    all.photons.insert(all.photons.end(), part.photons.begin(), part.photons.end());
    all.rays += part.rays;
  }
  return all;
}

std::uint64_t CausticPhotons::trace(std::uint32_t generation) {
  const float radius = first_radius_ * std::pow(static_cast<float>(generation + 1), kShrinking);
  std::uint64_t rays = 0;
  if (!spread_) {
    const Arrived pilot = trace_pilot();
    const std::uint64_t emitted = std::uint64_t{kPilotShares} * emitted_;
    emitted_ = worthwhile(emitted, pilot.photons.size());
    spread_.emplace(pilot.photons, static_cast<float>(kShares * emitted_) / static_cast<float>(emitted), first_radius_);
    rays += pilot.rays;
  }
  for (std::uint32_t share = 0; share < kShares; ++share) {
    const Arrived arrived = trace_range(generation, share * emitted_, emitted_);
    maps_[share] = {};
    maps_[share] = PhotonMaps(arrived.photons, *spread_, radius);
    rays += arrived.rays;
  }
  for (int level = 0; level < PhotonSpread::kLevels; ++level)
    photons_per_etendue_[level] = static_cast<float>(emitted_) * kPi * square(maps_[0].radius(level));
  return rays;
}

/// Whether photons go on from there into other directions than those of delta lobes.
bool scatters(const Vertex& vertex) {
  return vertex.scattering.is_lambertian();
}

/// The normal on the side from which the vertex is seen.
Vec3 facing_normal(const Vertex& vertex) {
  const Vec3& normal = vertex.surface.geometric_normal;
  return dot(normal, vertex.wo) < 0 ? -normal : normal;
}

/// Density with which photons leave a vertex along `w`, per étendue and emitted photon; `pdf` is that of the direction.
/// How many arrive there the pilot tells. Where a path's lookup there would find less than one photon, the path is
/// worth less than a sample of the chain: by as much, the photons' density is greater (Jendersie 2019, "Variance
/// reduction via footprint estimation in the presence of path reuse").
float CausticPhotons::scattered_density(const Vertex& vertex, const Vec3& w, float pdf) const {
  const Point3& position = vertex.surface.position;
  const float held = spread_->held(position);
  const float one = static_cast<float>(kShares) / static_cast<float>(1 << (2 * spread_->level(position)));
  const float all = static_cast<float>(kShares) * static_cast<float>(emitted_);
  return kScattered * std::max(held, one) / (kPi * square(first_radius_) * all) * pdf /
         std::abs(dot(w, vertex.surface.geometric_normal));
}

/// Sends a photon that arrived at a diffuse surface on towards mirrors and glass.
std::optional<Ray> CausticPhotons::scatter(const Vertex& vertex, Vec2 direction, Vec2 target_and_roulette,
                                           Photon& photon) const {
  if (target_and_roulette.y >= kScattered) return std::nullopt;
  const auto to = aim_.direction(vertex.surface.position, facing_normal(vertex), direction, target_and_roulette.x);
  if (!to) return std::nullopt;
  const Spectrum f_cos = vertex.scattering.eval(to->w).f_cos;
  if (f_cos.is_black()) return std::nullopt;
  photon.flux *= f_cos * (etendue_ratio(vertex, to->w) / (to->pdf * kScattered));
  photon.density = spread_ ? scattered_density(vertex, to->w, to->pdf) : 0.0f;
  ++photon.bounces;
  return Ray{offset_origin(vertex.surface, to->w), to->w};
}

/// What gleams at rough metal, paths find by light samples and by the metal's own directions: so often together.
float CausticPhotons::gleam_rival(const Receiver& at, std::uint32_t light, float pdf, float pdf_bsdf) const {
  return pdf_bsdf + pdf * light_density(scene_, light_samples_, at, light, 0);
}

/// Sends a photon from an infinite light on from the rough metal that it met first.
std::optional<Ray> CausticPhotons::reflect(const Vertex& vertex, std::uint32_t light, Vec2 direction, float choice,
                                           Photon& photon) const {
  const auto next = vertex.scattering.sample(direction, choice, TransportMode::importance);
  if (!next || next->is_delta()) return std::nullopt;
  const Vec3& ng = vertex.surface.geometric_normal;
  const float pdf = look_at_infinity(scene_.lights[light], vertex.wo).pdf;
  photon.flux *= next->weight * etendue_ratio(vertex, next->wi);
  photon.density *= next->pdf * std::abs(dot(vertex.wo, ng) / dot(next->wi, ng)) /
                    gleam_rival(receiver(vertex, next->wi), light, pdf, vertex.scattering.reverse_pdf(next->wi));
  if (photon.flux.is_black() || !std::isfinite(photon.density)) return std::nullopt;
  ++photon.bounces;
  photon.ends = true;
  return Ray{offset_origin(vertex.surface, next->wi), next->wi};
}

CausticPhotons::Gleam CausticPhotons::gleam(const SpecularChain& chain, const Vertex& vertex, const Vec3& wi) const {
  if (!(chain.pdf_bsdf > 0) || chain.bounces > 0 || !vertex.scattering.gleams()) return {};
  const Vec3& ng = vertex.surface.geometric_normal;
  return {chain, vertex.surface.position,
          vertex.scattering.reverse_pdf(wi) * std::abs(dot(wi, ng) / dot(vertex.wo, ng))};
}

float CausticPhotons::weight_of_gleam(const Gleam& gleam, const Receiver& at, std::uint32_t light, const Vec3& wi,
                                      float pdf, float pdf_bsdf) const {
  if (gleam.spread == 0) return 1;
  const float density = aim_.density_from_infinity(light, gleam.position, wi, pdf) * gleam.spread;
  return found_weight(gleam.seen, density / gleam_rival(at, light, pdf, pdf_bsdf));
}

/// Follows a photon along delta lobes, leaving a record wherever something else could scatter it.
std::uint64_t CausticPhotons::trace_one(std::uint32_t generation, std::uint32_t index,
                                        std::vector<Photon>& arrived) const {
  const PixelSampler sampler(sampler_, seed_, generation, kPhotonRow);
  const std::optional<EmittedRay> emitted =
      aim_.sample(sampler.point(kWhich, index), sampler.point(kPosition, index), sampler.point(kDirection, index),
                  sampler.point(kTarget, index).x);
  if (!emitted) return 0;
  Ray ray = emitted->ray;
  Photon photon;
  photon.flux = emitted->radiance * (1 / emitted->density);
  photon.density = emitted->density;
  int chain = 0;  // delta lobes since the light or a surface that scattered it otherwise
  std::uint64_t rays = 0;
  for (std::uint64_t surfaces = 0; surfaces < kMostSurfaces; ++surfaces) {
    const RayHit hit = scene_.geometry.intersect(ray);
    ++rays;
    if (!hit.found()) break;
    const Vertex vertex(scene_, ray, hit);
    const Vec2 bounce = sampler.point(kBounce + surfaces, index);
    if (chain > 0 && !vertex.scattering.is_delta()) {
      photon.position = vertex.surface.position;
      photon.normal = vertex.surface.geometric_normal;
      photon.wi = vertex.wo;
      const float kept = generation == kPilot ? 1.0f : spread_->kept(photon.position);
      if (sampler.point(kKeep + surfaces, index).x < kept) {
        arrived.push_back(photon);
        arrived.back().flux *= 1 / kept;
        arrived.back().density *= kept;
      }
      if (photon.ends) break;
      if (scatters(vertex)) {
        const std::optional<Ray> on = scatter(vertex, bounce, sampler.point(kScatter + surfaces, index), photon);
        if (!on) break;
        ray = *on;
        chain = 0;
        continue;
      }
    }
    if (photon.ends) break;
    if (photon.bounces == 0 && is_infinite(scene_.lights[emitted->light]) && vertex.scattering.gleams()) {
      const std::optional<Ray> on =
          reflect(vertex, emitted->light, bounce, sampler.point(kScatter + surfaces, index).x, photon);
      if (!on) break;
      ray = *on;
      chain = 1;
      continue;
    }
    const std::optional<BsdfSample> next = vertex.scattering.sample(Vec2(0.5f), bounce.x, TransportMode::importance);
    if (!next || !is_delta(next->lobe)) break;
    if (next->lobe != Lobe::straight) {
      if (++chain > kMostBounces) break;
      ++photon.bounces;
      const float etendue = etendue_ratio(vertex, next->wi);
      photon.flux *= next->weight * etendue;
      photon.density *= square(next->eta) / etendue;
      if (photon.flux.is_black()) break;
    }
    ray = {offset_origin(vertex.surface, next->wi), next->wi};
  }
  return rays;
}

CausticPhotons::Light CausticPhotons::radiance(const Vertex& vertex, int most_bounces, std::uint32_t sample) const {
  Light sum;
  const Vec3& normal = vertex.surface.geometric_normal;
  const Point3& position = vertex.surface.position;
  const int level = spread_->level(position);
  maps_[sample % kShares].for_each_near(position, level, [&](const Photon& photon) {
    if (photon.bounces > most_bounces || std::abs(dot(photon.normal, normal)) < kSameSurface) return;
    const BsdfEval eval = vertex.scattering.eval(photon.wi);
    const float cosine = std::abs(dot(photon.wi, normal));
    if (eval.f_cos.is_black() || cosine == 0) return;
    const float weight = mis_weight(photons_per_etendue_[level] * photon.density * cosine, eval.pdf);
    (photon.ends ? sum.ending : sum.passing) += eval.f_cos * photon.flux * (weight / cosine);
  });
  const float share = 1 / photons_per_etendue_[level];
  return {sum.passing * share, sum.ending * share};
}

float CausticPhotons::found_weight(const SpecularChain& chain, float density) const {
  const float photons = photons_per_etendue_[spread_->level(chain.position)] * spread_->kept(chain.position);
  return mis_weight(chain.pdf_bsdf, photons * density * chain.etendue * chain.cos_surface);
}

float CausticPhotons::weight_of_lit(const SpecularChain& chain, const Vertex& vertex) const {
  if (!chain.is_shared() || !scatters(vertex)) return 1;
  const float pdf = aim_.direction_pdf(vertex.surface.position, facing_normal(vertex), vertex.wo);
  return found_weight(chain, scattered_density(vertex, vertex.wo, pdf));
}

float CausticPhotons::weight_of_found(const SpecularChain& chain, std::uint32_t light, const LightHit& hit,
                                      const Vec3& wo) const {
  return chain.is_shared() ? found_weight(chain, aim_.density(light, hit, wo)) : 1.0f;
}

float CausticPhotons::weight_of_found(const SpecularChain& chain, std::uint32_t light, const Point3& position,
                                      const Vec3& wi, float pdf) const {
  return chain.is_shared() ? found_weight(chain, aim_.density_from_infinity(light, position, wi, pdf)) : 1.0f;
}

}  // namespace etendue
