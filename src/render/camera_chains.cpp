#include "render/camera_chains.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "render/branching.h"
#include "render/caustic_targets.h"
#include "render/dimensions.h"
#include "render/direct_light.h"

namespace etendue {
namespace {

constexpr int kBatch = Geometry::kBatch;

/// Beside each path that begins at a mirror or at glass.
constexpr int kChains = 6;
constexpr float kWeight = 1.0f / (1 + kChains);
/// What lies farther paths alone are left to find.
constexpr int kMostBounces = 64;
/// Packets of rays pay while they are still close.
constexpr int kCoherentBounces = 4;
/// Looks at a pixel before it is known whether it shows mirrors or glass; that many are one of each quarter.
constexpr int kFirstLooks = 4;
/// Added to the seed.
constexpr std::uint64_t kLookSeed = 0xc4a1'0001, kChainSeed = 0xc4a1'0002;

/// What is rendered, and its neighbours in the picture.
CropWindow with_border(const RenderSettings& settings) {
  const CropWindow seen = settings.crop.value_or(CropWindow{0, 0, settings.width, settings.height});
  const int x = std::max(seen.x - 1, 0), y = std::max(seen.y - 1, 0);
  return {x, y, std::min(seen.x + seen.width + 1, settings.width) - x,
          std::min(seen.y + seen.height + 1, settings.height) - y};
}

}  // namespace

struct CameraChains::Chain {
  Spectrum throughput{1};
  float eta_scale = 1;                ///< product of eta² along it
  int bounces = 0;                    ///< so far
  int branches_left = kMostBranches;  ///< of a path that goes the same way
  std::uint32_t number;               ///< kChains of a sample
};

/// Chains under way, and those to be followed after them.
struct CameraChains::Chains {
  int count = 0, count_later = 0;
  Ray ray[kBatch], ray_later[kBatch * kMostBranches];
  Chain chain[kBatch], chain_later[kBatch * kMostBranches];

  void add(const Ray& begun, const Chain& added) {
    ray[count] = begun;
    chain[count++] = added;
  }
  void add_later(const Ray& begun, const Chain& added) {
    ray_later[count_later] = begun;
    chain_later[count_later++] = added;
  }
  void take_up() {
    while (count < kBatch && count_later > 0) {
      --count_later;
      add(ray_later[count_later], chain_later[count_later]);
    }
  }
};

CameraChains::CameraChains(const RenderScene::Data& scene, const CameraRays& camera_rays,
                           const RenderSettings& settings)
    : scene_(scene),
      camera_rays_(camera_rays),
      sampler_(settings.sampler),
      seed_(settings.seed),
      window_(with_border(settings)),
      most_bounces_(std::min(settings.max_depth, kMostBounces)),
      hide_emitters_(settings.hide_emitters),
      possible_(most_bounces_ >= 1 && !scene.may_pass && camera_rays.all_weigh_alike() && has_lamps(scene) &&
                !specular_targets(scene).empty()) {}

std::uint64_t CameraChains::look_ahead() {
  if (!cells_.empty()) return 0;
  const auto rows = static_cast<std::size_t>(window_.height), columns = static_cast<std::size_t>(window_.width);
  std::vector<Mask> seen(rows * columns);
  std::vector<std::uint64_t> rays(rows);
  parallel_for(rows, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for (std::size_t column = 0; column < columns; ++column)
        rays[row] += look_at(window_.x + static_cast<int>(column), window_.y + static_cast<int>(row),
                             seen[row * columns + column]);
  });
  cells_.resize(seen.size());
  widen(seen);
  std::uint64_t sum = 0;
  for (const std::uint64_t of_row : rays) sum += of_row;
  return sum;
}

/// Which of a pixel's cells show mirrors or glass.
std::uint64_t CameraChains::look_at(int x, int y, Mask& seen) const {
  static_assert(kSide * kSide == kBatch, "the pixel's first points are one of each cell");
  const PixelSampler sampler(sampler_, seed_ + kLookSeed, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  float u[kBatch], v[kBatch], lens_u[kBatch], lens_v[kBatch];
  sampler.points(dimension::kFilm, 0, kBatch, u, v);
  sampler.points(dimension::kLens, 0, kBatch, lens_u, lens_v);
  std::uint64_t traced = 0;
  const auto look = [&](int begin, int end) {
    Ray rays[kBatch];
    RayHit hits[kBatch];
    const auto n = static_cast<std::size_t>(end - begin);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t at = static_cast<std::size_t>(begin) + i;
      rays[i] = camera_rays_.ray(x, y, {u[at], v[at]}, {lens_u[at], lens_v[at]});
    }
    scene_.geometry.intersect_coherent(std::span<const Ray>(rays, n), std::span(hits, n));
    traced += n;
    for (std::size_t i = 0; i < n; ++i) {
      traced += look_behind_lights(rays[i], hits[i]);
      const std::size_t at = static_cast<std::size_t>(begin) + i;
      if (hits[i].found() && Vertex(scene_, rays[i], hits[i]).scattering.is_delta()) seen |= cell({u[at], v[at]});
    }
  };
  look(0, kFirstLooks);
  if (seen != 0) look(kFirstLooks, kBatch);
  return traced;
}

/// By one cell all around, for one look sees little of it.
void CameraChains::widen(const std::vector<Mask>& seen) {
  const auto mark = [&](int column, int row) {
    if (column < 0 || row < 0 || !is_within(column / kSide, row / kSide)) return;
    cells_[index(column / kSide, row / kSide)] |= static_cast<Mask>(1u << (row % kSide * kSide + column % kSide));
  };
  for (int y = window_.y; y < window_.y + window_.height; ++y)
    for (int x = window_.x; x < window_.x + window_.width; ++x)
      for (std::uint32_t left = seen[index(x, y)]; left != 0; left &= left - 1) {
        const int at = std::countr_zero(left);
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) mark(x * kSide + at % kSide + dx, y * kSide + at / kSide + dy);
      }
}

float CameraChains::weight_of_found(int x, int y, const Vec2& film, int bounces) const {
  return bounces >= 1 && bounces <= most_bounces_ && (cells(x, y) & cell(film)) != 0 ? kWeight : 1.0f;
}

std::uint64_t CameraChains::follow(int x, int y, std::uint32_t first, std::span<PixelSample> samples) const {
  const Mask of_pixel = cells(x, y);
  if (of_pixel == 0) return 0;
  const PixelSampler sampler(sampler_, seed_ + kChainSeed, static_cast<std::uint32_t>(x),
                             static_cast<std::uint32_t>(y));
  std::uint64_t rays = 0;
  Chains chains;
  for (std::uint32_t sample = 0; sample < samples.size(); ++sample) {
    float u[kChains], v[kChains], lens_u[kChains], lens_v[kChains];
    const std::uint64_t begin = (std::uint64_t{first} + sample) * kChains;
    sampler.points(dimension::kFilm, begin, kChains, u, v);
    sampler.points(dimension::kLens, begin, kChains, lens_u, lens_v);
    for (int k = 0; k < kChains; ++k) {
      if ((of_pixel & cell({u[k], v[k]})) == 0) continue;
      chains.add(camera_rays_.ray(x, y, {u[k], v[k]}, {lens_u[k], lens_v[k]}), {.number = sample * kChains + k});
      if (chains.count == kBatch) rays += trace(chains, sampler, first, samples);
    }
  }
  return rays + trace(chains, sampler, first, samples);
}

/// Sends a chain on from where it is, as paths go: both ways early on, else as the random number says that draw()
/// gives. Most are reflected totally, which takes none.
template <typename Draw>
void CameraChains::go_on(const Chain& chain, const Vertex& vertex, Chains& chains, const Draw& draw) {
  const Scattering& scattering = vertex.scattering;
  // A polished surface may have both: a delta lobe, which the chain follows, and others, where it ends.
  const auto leave = [&](const std::optional<BsdfSample>& way, int branches_left, const auto& add) {
    if (!way || !way->is_delta()) return;
    const Chain next = {.throughput = chain.throughput * way->weight,
                        .eta_scale = chain.eta_scale * square(way->eta),
                        .bounces = chain.bounces + 1,
                        .branches_left = branches_left,
                        .number = chain.number};
    if (!next.throughput.is_black()) add({offset_origin(vertex.surface, way->wi), way->wi}, next);
  };
  const auto now = [&](const Ray& ray, const Chain& next) { chains.add(ray, next); };
  const auto later = [&](const Ray& ray, const Chain& next) { chains.add_later(ray, next); };
  const float worth =
      chain.branches_left > 0 ? worth_of_darker_way(scattering, chain.throughput, chain.eta_scale) : 0.0f;
  if (worth < kLeastBranch) {
    const bool is_certain = scattering.reflection_probability() == 1;
    leave(scattering.sample(Vec2(0.5f), is_certain ? 0 : draw()), chain.branches_left, now);
  } else {
    if (follows_branch(worth)) leave(one_way(scattering, false), 0, later);
    leave(one_way(scattering, true), chain.branches_left - 1, now);
  }
}

/// Follows chains to their ends.
std::uint64_t CameraChains::trace(Chains& chains, const PixelSampler& sampler, std::uint32_t first,
                                  std::span<PixelSample> samples) const {
  RayHit hits[kBatch];
  std::uint64_t traced = 0;
  for (int step = 0; chains.count > 0; ++step) {
    const auto n = static_cast<std::size_t>(chains.count);
    if (step <= kCoherentBounces)
      scene_.geometry.intersect_coherent(std::span<const Ray>(chains.ray, n), std::span(hits, n));
    else
      for (std::size_t c = 0; c < n; ++c) ::new (&hits[c]) RayHit(scene_.geometry.intersect(chains.ray[c]));
    traced += n;
    chains.count = 0;
    for (std::size_t c = 0; c < n; ++c) {
      Ray ray = chains.ray[c];
      const Chain chain = chains.chain[c];
      if (chain.bounces == 0) traced += look_behind_lights(ray, hits[c]);
      if (!hits[c].found()) continue;
      const Vertex vertex(scene_, ray, hits[c]);
      if (chain.bounces >= 1 && vertex.light != kNone)
        samples[chain.number / kChains].radiance += chain.throughput * vertex.emission * kWeight;
      if (chain.bounces == most_bounces_ || vertex.scattering.is_lambertian()) continue;
      go_on(chain, vertex, chains, [&] {
        const std::uint64_t number = std::uint64_t{first} * kChains + chain.number;
        return sampler.point(dimension::at(chain.bounces, dimension::kLobeAndRoulette), number).x;
      });
    }
    if (chains.count == 0) chains.take_up();
  }
  return traced;
}

/// Moves what a camera ray meets behind the lamps that are not to be seen. Returns the rays traced.
std::uint64_t CameraChains::look_behind_lights(Ray& ray, RayHit& hit) const {
  if (!hide_emitters_) return 0;
  const Meeting behind = behind_lights(scene_, ray, hit);
  ray = behind.ray;
  hit = behind.hit;
  return static_cast<std::uint64_t>(behind.rays);
}

}  // namespace etendue
