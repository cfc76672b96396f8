#include "render/long_chains.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "render/caustic_targets.h"
#include "render/dimensions.h"
#include "render/direct_light.h"
#include "render/vertex.h"

namespace etendue {
namespace {

constexpr int kBatch = Geometry::kBatch;

/// Bounces of chains that are long: fewer lead through a glass and show what is behind it, which paths find. Of more
/// than the second paths alone are left to find lamps.
constexpr int kFewestBounces = 5, kMostBounces = 64;
/// Chains beside each path: where most of the light is led on for long, and where glass is seen elsewhere.
constexpr int kMany = 8, kFew = 2;
constexpr float weight_beside(int chains) {
  return 1.0f / static_cast<float>(1 + chains);
}
/// Packets of rays pay while they are still close.
constexpr int kCoherentBounces = 4;
/// Looks at a pixel before it is known whether it shows more than diffuse surfaces; that many are one of each quarter.
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

struct LongChains::Chains {
  int count = 0;
  Ray ray[kBatch];
  Spectrum throughput[kBatch];
  std::uint32_t number[kBatch];  ///< for whoever follows it

  void add(const Ray& begun, float weight, std::uint32_t of_whom) {
    ray[count] = begun;
    throughput[count] = Spectrum(weight);
    number[count++] = of_whom;
  }
};

LongChains::LongChains(const RenderScene::Data& scene, const CameraRays& camera_rays, const RenderSettings& settings)
    : scene_(scene),
      camera_rays_(camera_rays),
      sampler_(settings.sampler),
      seed_(settings.seed),
      window_(with_border(settings)),
      most_bounces_(std::min(settings.max_depth, kMostBounces)),
      hide_emitters_(settings.hide_emitters),
      possible_(most_bounces_ >= kFewestBounces && !scene.may_pass && camera_rays.all_weigh_alike() &&
                has_lamps(scene) && !specular_targets(scene).empty()) {}

/// Follows chains to their ends. choose(number, bounce, scattering) is the random number that picks a delta lobe;
/// meet(number, bounces, throughput, vertex) is called wherever one arrives.
template <typename Choose, typename Meet>
std::uint64_t LongChains::trace(Chains& chains, int most_bounces, const Choose& choose, const Meet& meet) const {
  RayHit hits[kBatch];
  std::uint64_t traced = 0;
  for (int bounce = 0; chains.count > 0; ++bounce) {
    const auto n = static_cast<std::size_t>(chains.count);
    if (bounce <= kCoherentBounces)
      scene_.geometry.intersect_coherent(std::span<const Ray>(chains.ray, n), std::span(hits, n));
    else
      for (std::size_t c = 0; c < n; ++c) ::new (&hits[c]) RayHit(scene_.geometry.intersect(chains.ray[c]));
    traced += n;
    chains.count = 0;
    for (std::size_t c = 0; c < n; ++c) {
      if (bounce == 0 && hide_emitters_) {
        const Meeting behind = behind_lights(scene_, chains.ray[c], hits[c]);
        chains.ray[c] = behind.ray;
        hits[c] = behind.hit;
        traced += static_cast<std::uint64_t>(behind.rays);
      }
      if (!hits[c].found()) continue;
      const Vertex vertex(scene_, chains.ray[c], hits[c]);
      const std::uint32_t number = chains.number[c];
      meet(number, bounce, chains.throughput[c], vertex);
      if (bounce == most_bounces || vertex.scattering.is_lambertian()) continue;
      // A polished surface may have both: a delta lobe, which the chain follows, and others, where it ends.
      const std::optional<BsdfSample> next =
          vertex.scattering.sample(Vec2(0.5f), choose(number, bounce, vertex.scattering));
      if (!next || !next->is_delta()) continue;
      const Spectrum throughput = chains.throughput[c] * next->weight;
      if (throughput.is_black()) continue;
      chains.ray[chains.count] = {offset_origin(vertex.surface, next->wi), next->wi};
      chains.throughput[chains.count] = throughput;
      chains.number[chains.count++] = number;
    }
  }
  return traced;
}

std::uint64_t LongChains::look_ahead() {
  if (!cells_.empty()) return 0;
  const auto rows = static_cast<std::size_t>(window_.height), columns = static_cast<std::size_t>(window_.width);
  std::vector<Cells> found(rows * columns);
  std::vector<std::uint64_t> rays(rows);
  parallel_for(rows, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for (std::size_t column = 0; column < columns; ++column)
        rays[row] += look_at(window_.x + static_cast<int>(column), window_.y + static_cast<int>(row),
                             found[row * columns + column]);
  });
  cells_.resize(found.size());
  widen(found, &Cells::glass);
  widen(found, &Cells::leads);
  std::uint64_t sum = 0;
  for (const std::uint64_t of_row : rays) sum += of_row;
  return sum;
}

/// Where a pixel's chains are long if each goes the way that most of the light goes: what leaves it early on, paths
/// find by going both ways.
std::uint64_t LongChains::look_at(int x, int y, Cells& found) const {
  static_assert(kSide * kSide == kBatch, "the pixel's first points are one of each cell");
  const PixelSampler sampler(sampler_, seed_ + kLookSeed, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  float u[kBatch], v[kBatch], lens_u[kBatch], lens_v[kBatch];
  sampler.points(dimension::kFilm, 0, kBatch, u, v);
  sampler.points(dimension::kLens, 0, kBatch, lens_u, lens_v);
  const auto more_light = [](std::uint32_t, int, const Scattering& scattering) {
    return scattering.reflection_probability().value_or(1) < 0.5f ? kOneMinusEpsilon : 0.0f;
  };
  bool is_specular = false;  // what is seen first
  const auto meet = [&](std::uint32_t place, int bounces, const Spectrum&, const Vertex& vertex) {
    const auto here = static_cast<Mask>(place);
    if (bounces == 0) is_specular |= !vertex.scattering.is_lambertian();
    if (bounces == 0 && vertex.scattering.reflection_probability()) found.glass |= here;
    if (bounces == kFewestBounces) found.leads |= here;
  };
  const auto look = [&](int begin, int end) {
    Chains chains;
    for (int i = begin; i < end; ++i)
      chains.add(camera_rays_.ray(x, y, {u[i], v[i]}, {lens_u[i], lens_v[i]}), 1, cell({u[i], v[i]}));
    return trace(chains, kFewestBounces, more_light, meet);
  };
  const std::uint64_t rays = look(0, kFirstLooks);
  return is_specular ? rays + look(kFirstLooks, kBatch) : rays;
}

/// By one cell all around, for one look sees little of it.
void LongChains::widen(const std::vector<Cells>& found, Mask Cells::*which) {
  const auto mark = [&](int column, int row) {
    if (column < 0 || row < 0 || !is_within(column / kSide, row / kSide)) return;
    cells_[index(column / kSide, row / kSide)].*which |=
        static_cast<Mask>(1u << (row % kSide * kSide + column % kSide));
  };
  for (int y = window_.y; y < window_.y + window_.height; ++y)
    for (int x = window_.x; x < window_.x + window_.width; ++x)
      for (std::uint32_t left = found[index(x, y)].*which; left != 0; left &= left - 1) {
        const int at = std::countr_zero(left);
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) mark(x * kSide + at % kSide + dx, y * kSide + at / kSide + dy);
      }
}

/// How many chains are followed beside a path that begins there.
int LongChains::chains_beside(int x, int y, const Vec2& film) const {
  const Cells of_pixel = cells(x, y);
  const Mask here = cell(film);
  return (of_pixel.leads & here) != 0 ? kMany : (of_pixel.glass & here) != 0 ? kFew : 0;
}

float LongChains::weight_of_found(int x, int y, const Vec2& film, int bounces) const {
  return bounces < kFewestBounces || bounces > most_bounces_ ? 1.0f : weight_beside(chains_beside(x, y, film));
}

std::uint64_t LongChains::follow(int x, int y, std::uint32_t first, std::span<PixelSample> samples) const {
  const Cells of_pixel = cells(x, y);
  const int most = of_pixel.leads != 0 ? kMany : of_pixel.glass != 0 ? kFew : 0;  // beside one path
  if (most == 0) return 0;
  const PixelSampler sampler(sampler_, seed_ + kChainSeed, static_cast<std::uint32_t>(x),
                             static_cast<std::uint32_t>(y));
  // Chain `number` of these samples is one of sample number / kMany.
  const std::uint64_t first_number = std::uint64_t{first} * kMany;
  const auto choose = [&](std::uint32_t number, int bounce, const Scattering&) {
    return sampler.point(dimension::at(bounce, dimension::kLobeAndRoulette), first_number + number).x;
  };
  const auto meet = [&](std::uint32_t number, int bounces, const Spectrum& throughput, const Vertex& vertex) {
    if (bounces >= kFewestBounces && vertex.light != kNone)
      samples[number / kMany].radiance += throughput * vertex.emission;
  };
  std::uint64_t rays = 0;
  Chains chains;
  for (std::uint32_t sample = 0; sample < samples.size(); ++sample) {
    float u[kMany], v[kMany], lens_u[kMany], lens_v[kMany];
    const std::uint64_t begin = first_number + sample * kMany;
    sampler.points(dimension::kFilm, begin, most, u, v);
    sampler.points(dimension::kLens, begin, most, lens_u, lens_v);
    for (int k = 0; k < most; ++k) {
      const int beside = chains_beside(x, y, {u[k], v[k]});
      if (k >= beside) continue;
      chains.add(camera_rays_.ray(x, y, {u[k], v[k]}, {lens_u[k], lens_v[k]}), weight_beside(beside),
                 sample * kMany + k);
      if (chains.count == kBatch) rays += trace(chains, most_bounces_, choose, meet);
    }
  }
  return rays + trace(chains, most_bounces_, choose, meet);
}

}  // namespace etendue
