#include "render/caustic_photons.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "render/caustic_targets.h"
#include "render/direct_light.h"
#include "sampling/sampler.h"

namespace etendue {
namespace {

constexpr int kMostBounces = SpecularChain::kMostBounces;
/// One photon is emitted for so many samples of pixels, as far as a generation's bounds allow.
constexpr std::uint64_t kSamplesPerPhoton = 2 * Geometry::kBatch;
constexpr std::uint64_t kMostPhotons = 1 << 21;
constexpr std::uint32_t kChunk = 1024;
/// Of the first generation, in pixels as wide as they are at most of the surfaces that the camera sees.
constexpr float kRadiusInPixels = 0.75f;
/// r² ∝ (generation + 1)^−⅓ (Knaus and Zwicker 2011, eq. 10 with α = ⅔, as a power).
constexpr float kShrinking = -1.0f / 6;
/// Instead of a generation: photons that only show where the others will be.
constexpr std::uint32_t kPilot = 0xffff'ffffu;
/// Photons on surfaces that turn away by more than this cosine are not those of this surface.
constexpr float kSameSurface = 0.7f;
/// In place of a pixel's row, which no picture reaches: photons' random numbers.
constexpr std::uint32_t kPhotonRow = 0xffff'fff0u, kPilotRow = 0xffff'fff1u;

/// Dimensions of a photon's random numbers.
enum : std::uint64_t { kWhich, kPosition, kDirection, kTarget, kBounce, kKeep = kBounce + 2 * kMostBounces };

Vec2 point(const PixelSampler& sampler, std::uint64_t dimension, std::uint32_t index) {
  Vec2 u;
  sampler.points(dimension, index, 1, &u.x, &u.y);
  return u;
}

/// Width of a pixel at the first surfaces with more than delta lobes that the camera sees, whichever way it sees them:
/// a width that three quarters of them exceed. 0 if there are none.
float usual_pixel_width(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings) {
  constexpr int kRays = 32, kMirrors = 12;
  if (camera.projection != Projection::perspective && camera.projection != Projection::orthographic) return 0;
  const float per_metre = 2 * camera.tan_half_x / static_cast<float>(settings.width);
  std::vector<float> widths;
  for (std::uint32_t i = 0; i < kRays * kRays; ++i) {
    const PixelSampler sampler(SamplerKind::independent, 0, i, kPilotRow);
    Ray ray = generate_ray(
        camera, Vec2(static_cast<float>(i % kRays) + 0.5f, static_cast<float>(i / kRays) + 0.5f) * (1.0f / kRays),
        {0.5f, 0.5f});
    float way = 0;
    for (std::uint32_t bounce = 0; bounce < kMirrors; ++bounce) {
      const RayHit hit = scene.geometry.intersect(ray);
      if (!hit.found()) break;
      way += hit.t;
      const Vertex vertex = find_vertex(scene, ray, hit);
      if (!vertex.scattering.is_delta()) {
        widths.push_back(camera.projection == Projection::perspective ? per_metre * way : per_metre);
        break;
      }
      const auto sample = vertex.scattering.sample(point(sampler, bounce, 0), point(sampler, bounce, 1).x);
      if (!sample) break;
      ray = {offset_origin(vertex.surface, sample->wi), sample->wi};
    }
  }
  if (widths.empty()) return 0;
  const auto quarter = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 4);
  std::nth_element(widths.begin(), quarter, widths.end());
  return *quarter;
}

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
    : scene_(scene), sampler_(settings.sampler), seed_(settings.seed) {
  if (!scene.media.empty()) return;
  aim_ = LightAim(scene.lights, specular_targets(scene), scene.geometry.bounds());
  if (!aim_.possible()) return;
  first_radius_ = kRadiusInPixels * usual_pixel_width(scene, camera, settings);
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  emitted_ = static_cast<std::uint32_t>(std::min(pixels * generation_size / kSamplesPerPhoton, kMostPhotons) / kShares);
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
    const Arrived pilot = trace_range(kPilot, 0, kShares * emitted_);
    spread_.emplace(pilot.photons, first_radius_);
    rays += pilot.rays;
  }
  for (std::uint32_t share = 0; share < kShares; ++share) {
    const Arrived arrived = trace_range(generation, share * emitted_, emitted_);
    maps_[share] = PhotonMaps(arrived.photons, *spread_, radius);
    rays += arrived.rays;
  }
  for (int level = 0; level < PhotonSpread::kLevels; ++level)
    photons_per_etendue_[level] = static_cast<float>(emitted_) * kPi * square(maps_[0].radius(level));
  return rays;
}

/// Follows a photon along delta lobes, leaving a record wherever something else could scatter it.
std::uint64_t CausticPhotons::trace_one(std::uint32_t generation, std::uint32_t index,
                                        std::vector<Photon>& arrived) const {
  const PixelSampler sampler(sampler_, seed_, generation, kPhotonRow);
  const std::optional<EmittedRay> emitted =
      aim_.sample(point(sampler, kWhich, index), point(sampler, kPosition, index), point(sampler, kDirection, index),
                  point(sampler, kTarget, index).x);
  if (!emitted) return 0;
  Ray ray = emitted->ray;
  Photon photon;
  photon.flux = emitted->radiance * (1 / emitted->density);
  photon.density = emitted->density;
  std::uint64_t rays = 0;
  for (std::uint64_t surfaces = 0; surfaces < 2 * kMostBounces; ++surfaces) {
    const RayHit hit = scene_.geometry.intersect(ray);
    ++rays;
    if (!hit.found()) break;
    const Vertex vertex = find_vertex(scene_, ray, hit);
    if (photon.bounces > 0 && !vertex.scattering.is_delta()) {
      photon.position = vertex.surface.position;
      photon.normal = vertex.surface.geometric_normal;
      photon.wi = vertex.wo;
      const float kept = generation == kPilot ? 1.0f : spread_->kept(photon.position);
      if (point(sampler, kKeep + surfaces, index).x < kept) {
        arrived.push_back(photon);
        arrived.back().flux *= 1 / kept;
        arrived.back().density *= kept;
      }
    }
    const Vec2 choice = point(sampler, kBounce + surfaces, index);
    const std::optional<BsdfSample> next = vertex.scattering.sample(Vec2(0.5f), choice.x, TransportMode::importance);
    if (!next || !is_delta(next->lobe)) break;
    if (next->lobe != Lobe::straight) {
      if (++photon.bounces > kMostBounces) break;
      const float etendue = etendue_ratio(vertex, next->wi);
      photon.flux *= next->weight * etendue;
      photon.density *= square(next->eta) / etendue;
      if (photon.flux.is_black()) break;
    }
    ray = {offset_origin(vertex.surface, next->wi), next->wi};
  }
  return rays;
}

Spectrum CausticPhotons::radiance(const Vertex& vertex, int most_bounces, std::uint32_t sample) const {
  Spectrum sum;
  const Vec3& normal = vertex.surface.geometric_normal;
  const Point3& position = vertex.surface.position;
  const int level = spread_->level(position);
  maps_[sample % kShares].for_each_near(position, level, [&](const Photon& photon) {
    if (photon.bounces > most_bounces || std::abs(dot(photon.normal, normal)) < kSameSurface) return;
    const BsdfEval eval = vertex.scattering.eval(photon.wi);
    const float cosine = std::abs(dot(photon.wi, normal));
    if (eval.f_cos.is_black() || cosine == 0) return;
    const float weight = mis_weight(photons_per_etendue_[level] * photon.density * cosine, eval.pdf);
    sum += eval.f_cos * photon.flux * (weight / cosine);
  });
  return sum * (1 / photons_per_etendue_[level]);
}

float CausticPhotons::found_weight(const SpecularChain& chain, float density) const {
  const float photons = photons_per_etendue_[spread_->level(chain.position)] * spread_->kept(chain.position);
  return mis_weight(chain.pdf_bsdf, photons * density * chain.etendue * chain.cos_surface);
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
