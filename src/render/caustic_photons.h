#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "camera/camera.h"
#include "lights/emission.h"
#include "photons/photon_spread.h"
#include "render/scene_data.h"
#include "render/settings.h"
#include "render/vertex.h"

namespace etendue {

/// How étendue changes where light is scattered by a delta lobe from the direction `wo` to `wi`, both leaving the
/// surface: n² dA cos θ dω after / before. 1 unless the shading normal is not the geometric one (Veach 1997, section
/// 5.3.2).
float etendue_ratio(const Vertex& vertex, const Vec3& wi);

/// The way of a path from the last vertex that light sampling and photons can reach, along delta lobes: the part of it
/// for which photons are another technique.
struct SpecularChain {
  float pdf_bsdf = 0;     ///< of its first direction; 0: there is no such vertex
  float cos_surface = 0;  ///< between that direction and the surface's geometric normal
  Point3 position{0, 0, 0};
  float etendue = 1;  ///< dA cos θ dω at the other end / at that vertex
  int bounces = 0;    ///< delta lobes since

  static constexpr int kMostBounces = 32;  ///< of those that photons follow
  bool is_shared() const { return pdf_bsdf > 0 && bounces > 0 && bounces <= kMostBounces; }

  /// Another one, into `wi`.
  void bounce(const Vertex& vertex, const Vec3& wi, float eta) {
    etendue *= etendue_ratio(vertex, wi) / square(eta);
    ++bounces;
  }
};

/// Light that reaches surfaces by way of mirrors and smooth glass alone. Path tracing finds it only where a ray happens
/// to hit the light at the end of such a chain; photons find it from the other end (Jensen 1996). At each vertex that
/// light can be sampled from, the radiance of such chains is the sum of both, weighted by multiple importance sampling
/// (the merging technique of Georgiev et al. 2012 and Hachisuka et al. 2012). Where photons arrive on a diffuse surface
/// some are scattered towards mirrors and glass again: paths that follow such a chain from its other end to a surface
/// where photons are weigh what they find there accordingly. Light from infinity that rough metal reflects first is
/// found in the same way. All other light is left to path tracing.
///
/// Étendue is kept along a chain, so that the densities of both techniques are compared without going through its
/// vertices: with N photons, each emitted with density p per étendue, a disk of radius r finds N π r² p cos θ of them
/// per solid angle at the vertex.
///
/// The radius shrinks from one generation of photons to the next so that the estimate converges to the true one (Knaus
/// and Zwicker 2011).
class CausticPhotons {
 public:
  /// The scene must outlive it. A generation of photons serves so many samples of a pixel.
  CausticPhotons(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings,
                 std::uint32_t generation_size);

  /// Whether light can arrive by way of delta lobes alone at what the camera sees.
  bool possible() const { return aim_.possible() && first_radius_ > 0; }

  /// Replaces the photons by those of another generation; the same for any number of threads. Returns the rays traced.
  std::uint64_t trace(std::uint32_t generation);

  /// Radiance towards wo, of photons that are scattered on here, and of those that end.
  struct Light {
    Spectrum passing, ending;
  };
  /// That of the photons near `vertex` that at most `most_bounces` bounces led there, for a sample of this number:
  /// those of a pixel look at nearly the same place, so each looks at its share of the photons only.
  Light radiance(const Vertex& vertex, int most_bounces, std::uint32_t sample) const;

  /// Weight of a chain that a path followed until it met a light from the front, at `hit`, or infinity, seen from
  /// `position` along `wi` with sample_light's density `pdf`.
  float weight_of_found(const SpecularChain& chain, std::uint32_t light, const LightHit& hit, const Vec3& wo) const;
  float weight_of_found(const SpecularChain& chain, std::uint32_t light, const Point3& position, const Vec3& wi,
                        float pdf) const;
  /// How light of an infinite light along `wi` would gleam at the vertex at the end of a path: a rough metal seen from
  /// a surface where photons are looked up.
  struct Gleam {
    SpecularChain seen;  ///< from where, and how
    Point3 position{0, 0, 0};
    float spread = 0;  ///< étendue's density behind / before; 0: photons do not find this light
  };
  Gleam gleam(const SpecularChain& chain, const Vertex& vertex, const Vec3& wi) const;
  /// Weight of that light, which light samples find with density `pdf` and the vertex' BSDF with `pdf_bsdf`, weighed
  /// against each other already.
  float weight_of_gleam(const Gleam& gleam, const Receiver& at, std::uint32_t light, const Vec3& wi, float pdf,
                        float pdf_bsdf) const;
  /// Weight of the chain's light that the photons around `vertex`, at its end, are an estimate of: they are scattered
  /// there as well, and some follow the chain back.
  float weight_of_lit(const SpecularChain& chain, const Vertex& vertex) const;

 private:
  struct Arrived;
  Arrived trace_pilot();
  std::uint32_t worthwhile(std::uint64_t emitted, std::uint64_t arrived) const;
  Arrived trace_range(std::uint32_t generation, std::uint32_t first, std::uint32_t count) const;
  std::uint64_t trace_one(std::uint32_t generation, std::uint32_t index, std::vector<Photon>& arrived) const;
  float gleam_rival(const Receiver& at, std::uint32_t light, float pdf, float pdf_bsdf) const;
  std::optional<Ray> reflect(const Vertex& vertex, std::uint32_t light, Vec2 direction, float choice,
                             Photon& photon) const;
  std::optional<Ray> scatter(const Vertex& vertex, Vec2 direction, Vec2 target_and_roulette, Photon& photon) const;
  float scattered_density(const Vertex& vertex, const Vec3& w, float pdf) const;
  float found_weight(const SpecularChain& chain, float density) const;

  const RenderScene::Data& scene_;
  SamplerKind sampler_;
  std::uint64_t seed_;
  int light_samples_;
  LightAim aim_;
  std::optional<PhotonSpread> spread_;  ///< once it is known
  static constexpr std::uint32_t kShares = 8;
  std::array<PhotonMaps, kShares> maps_;
  std::uint32_t emitted_ = 0;    ///< of each share of a generation
  std::uint64_t most_kept_ = 0;  ///< of those that arrive, so many fit into the memory of a share
  float first_radius_ = 0;
  /// Of each level, emitted · π r²: times a density per étendue and cos θ, that of merging per steradian.
  std::array<float, PhotonSpread::kLevels> photons_per_etendue_{};
};

}  // namespace etendue
