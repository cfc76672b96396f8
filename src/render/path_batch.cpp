#include "render/path_batch.h"

#include "render/cache_filler.h"
#include "render/dimensions.h"

namespace etendue {
namespace {

/// Paths of fewer bounces than this are never ended by roulette, unless they passed straight through very many
/// surfaces.
constexpr int kRouletteStart = 5, kManySegments = 1000;
constexpr float kMaxSurvival = 0.99f;

/// A wave of branches draws random numbers of so many bounces of its own.
constexpr int kBouncesOfWave = 1 << 16;

}  // namespace

PathBatch::PathBatch(const PathCommons& common, int x, int y, std::uint32_t first, std::span<PixelSample> samples,
                     std::span<SharedPath> shared, std::span<std::optional<RadianceRecord>> records)
    : common_(common),
      scene_(common.scene),
      sampler_(common.settings.sampler, common.settings.seed + (records.empty() ? 0 : kRecordSeed),
               static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
               records.empty() ? static_cast<std::uint32_t>(common.settings.samples_per_pixel) : 0),
      first_(first),
      samples_(samples),
      shared_(shared),
      records_(records),
      x_(x),
      y_(y),
      count_(static_cast<int>(samples.size())) {
  start();
}

std::uint64_t PathBatch::run() {
  follow(0);
  for (int wave = 1; take_up_branches(); ++wave) follow(wave * kBouncesOfWave);
  return rays_;
}

void PathBatch::start() {
  Ray rays[kBatch];
  common_.camera_rays.generate(sampler_, x_, y_, first_, std::span(rays, count_), samples_);
  scene_.geometry.intersect_coherent(std::span<const Ray>(rays, count_), std::span(hits_, count_));
  rays_ += count_;
  for (int i = 0; i < count_; ++i) {
    paths_[i].ray = rays[i];
    if (!shared_.empty()) paths_[i].sharing = Path::Sharing::seeks_first;
    if (!records_.empty()) paths_[i].sharing = Path::Sharing::seeks_record;
    branches_left_[i] = kMostBranches;
    active_[active_count_++] = i;
  }
}

void PathBatch::follow(int first_bounce) {
  for (int bounce = first_bounce; active_count_ > 0; ++bounce) {
    if (bounce > 0) intersect();
    if (common_.settings.hide_emitters) look_behind_lights(bounce);
    arrive(bounce);
    if (!shared_.empty()) share();
    if (common_.photons) weigh_caustics();
    if (common_.cell_side > 0) look_up();
    if (common_.photons) gather_photons();
    if (common_.hemisphere)
      sample_hemisphere(bounce);
    else
      sample_lights(bounce);
    if (common_.looks > 1) look_for_lights(bounce);
    scatter(bounce);
  }
}

void PathBatch::intersect() {
  // Made where they stay: a copy would wait until they are written.
  for (int a = 0; a < active_count_; ++a)
    ::new (&hits_[active_[a]]) RayHit(scene_.geometry.intersect(paths_[active_[a]].ray));
  rays_ += active_count_;
}

/// The camera sees neither the lights that it is not to see nor their shapes. Where passing a surface is a bounce, what
/// lies behind one is not seen directly.
void PathBatch::look_behind_lights(int bounce) {
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (!paths_[i].from_camera || (bounce > 0 && common_.settings.null_counts_as_bounce)) continue;
    const Meeting behind = behind_lights(scene_, paths_[i].ray, hits_[i]);
    paths_[i].ray = behind.ray;
    hits_[i] = behind.hit;
    rays_ += static_cast<std::uint64_t>(behind.rays);
  }
}

void PathBatch::arrive(int bounce) {
  see_infinity();
  int kept = 0;
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (!hits_[i].found()) continue;
    const Vertex& vertex = vertices_.emplace(i, scene_, paths_[i].ray, hits_[i]);
    if (vertex.light != kNone && paths_[i].sharing != Path::Sharing::seeks_record) see_emission(i);
    if (bounce == 0) {
      common_.camera_rays.describe(paths_[i].ray, vertex.surface, samples_[i]);
      samples_[i].albedo = vertex.scattering.albedo();
    }
    if (may_bounce(i) || may_pass_freely(vertex)) active_[kept++] = i;
  }
  active_count_ = kept;
}

/// Leaves the first vertex that looks for lights and, if it is Lambertian, the next one to other pixels. From there on
/// what the path finds is theirs too.
void PathBatch::share() {
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    Path& path = paths_[i];
    const Vertex& vertex = vertices_[i];
    SharedPath& shared = shared_[i];
    if (path.sharing == Path::Sharing::seeks_first && seeks_lights(i)) {
      shared.has_first = true;
      shared.first = vertex;
      shared.throughput = path.throughput;
      shared.depth = path.depth;
    } else if (path.sharing == Path::Sharing::left_first) {
      path.sharing = Path::Sharing::keeps;
      if (!vertex.scattering.is_lambertian()) continue;
      shared.has_second = true;
      shared.second = vertex.surface;
      path.sharing = Path::Sharing::shares;
      path.prefix = path.throughput;
      path.throughput = Spectrum(path.inverse_survival);
    }
  }
}

/// What the paths' vertices count for as places where photons are.
void PathBatch::weigh_caustics() {
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (!seeks_lights(i)) continue;
    Path& path = paths_[i];
    if (path.chain.is_shared()) {
      path.caustics *= common_.photons->weight_of_lit(path.chain, vertices_[i]);
    } else {
      path.caustics = 1;
      path.records_caustics = false;
    }
  }
}

/// Ends the paths that come to something known, and starts the records of those that seek one.
void PathBatch::look_up() {
  int kept = 0;
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    Path& path = paths_[i];
    if (is_known(i)) continue;
    active_[kept++] = i;
    if (path.sharing != Path::Sharing::seeks_record) continue;
    records_[i] = record_at(i);
    if (!records_[i]) continue;
    path.sharing = Path::Sharing::records;
    path.throughput = Spectrum(1);  // whatever is seen from here belongs to others as well
    path.caustics = 1;
    path.records_caustics = true;
    vertices_[i].scattering.whiten();
  }
  active_count_ = kept;
}

/// Light that photons bring to the paths' vertices.
void PathBatch::gather_photons() {
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (!seeks_lights(i)) continue;
    const Path& path = paths_[i];
    const CausticPhotons::Light light = common_.photons->radiance(
        vertices_[i], common_.settings.max_depth - path.depth - 1, first_ + static_cast<std::uint32_t>(i));
    caustics_of(i) += path.throughput * path.caustics * light.passing;
    radiance_of(i) += path.throughput * light.ending;
  }
}

/// Of what a path finds, for roulette. What nothing but mirrors and glass has scattered has to find lamps by chance,
/// and its branches are to last: it is worth all while it is worth branching.
float PathBatch::worth(const Path& path) {
  const float share = (path.throughput * path.prefix).max() * path.eta_scale;
  return path.scatterings > 0 ? share : share / kLeastBranch;
}

/// Every path goes on into a direction that its BSDF chooses, or straight through a surface that is not there, or ends.
void PathBatch::scatter(int bounce) {
  float u[kBatch], v[kBatch], choice[kBatch], roulette[kBatch];
  sampler_.points(dimension::at(bounce, dimension::kDirection), first_, count_, u, v);
  sampler_.points(dimension::at(bounce, dimension::kLobeAndRoulette), first_, count_, choice, roulette);
  int kept = 0;
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    const Vertex& vertex = vertices_[i];
    Path& path = paths_[i];
    const std::optional<BsdfSample> sample =
        branches_off(i) ? branch_off(i) : vertex.scattering.sample({u[i], v[i]}, choice[i]);
    if (!sample || !leave(i, path, *sample)) continue;
    path.inverse_survival = 1;
    if (path.depth >= kRouletteStart || bounce % kBouncesOfWave >= kManySegments) {
      const float survival = std::min(worth(path), kMaxSurvival);
      if (roulette[i] >= survival) continue;
      path.inverse_survival = 1 / survival;
      path.throughput *= path.inverse_survival;
    }
    if (path.throughput.is_black()) continue;
    active_[kept++] = i;
  }
  active_count_ = kept;
}

/// Sends a path on from path i's vertex. False if it ends there.
bool PathBatch::leave(int i, Path& path, const BsdfSample& sample) {
  const Vertex& vertex = vertices_[i];
  if (sample.lobe == Lobe::straight) {
    path.depth += common_.settings.null_counts_as_bounce ? 1 : 0;
  } else {
    if (!may_bounce(i)) return false;
    path.depth += 1;
    if (common_.photons) path.gleam = common_.photons->gleam(path.chain, vertex, sample.wi);
    path.pdf_bsdf = sample.pdf;
    path.scattered_at = asking(i);
    path.from_camera = false;
    if (path.sharing == Path::Sharing::seeks_first && !vertex.scattering.is_delta()) leave_first(i, sample);
    if (!sample.is_delta()) {
      path.bsdf_samples = static_cast<float>(bsdf_samples(i));
      path.light_samples = static_cast<float>(light_samples(i, path));
      ++path.scatterings;
    }
    if (sample.is_delta())
      path.chain.bounce(vertex, sample.wi, sample.eta);
    else
      path.chain = {sample.pdf, std::abs(dot(sample.wi, vertex.surface.geometric_normal)), vertex.surface.position};
  }
  path.throughput *= sample.weight;
  path.eta_scale *= square(sample.eta);
  path.ray = {offset_origin(vertex.surface, sample.wi), sample.wi};
  return !path.throughput.is_black();
}

/// Path i is scattered by the vertex that its neighbours may share: off to the next one, unless by a delta lobe.
void PathBatch::leave_first(int i, const BsdfSample& sample) {
  paths_[i].sharing = Path::Sharing::keeps;
  if (sample.is_delta()) return;
  paths_[i].sharing = Path::Sharing::left_first;
  shared_[i].f_cos = sample.weight * sample.pdf;
  shared_[i].pdf = sample.pdf;
}

/// Whether path i, which the camera sent out, meets glass and both ways from there are worth following.
bool PathBatch::branches_off(int i) const {
  const Path& path = paths_[i];
  if (!common_.splits || !records_.empty() || path.chain.pdf_bsdf > 0 || branches_left_[i] == 0) return false;
  return worth_of_darker_way(vertices_[i].scattering, path.throughput, path.eta_scale) >= kLeastBranch;
}

/// Leaves the darker of the two ways for later and returns the other.
std::optional<BsdfSample> PathBatch::branch_off(int i) {
  const Scattering& scattering = vertices_[i].scattering;
  --branches_left_[i];
  Path branch = paths_[i];
  branch.sharing = Path::Sharing::keeps;
  if (!branch.is_branch)
    branch.is_among_chains =
        CameraChains::follows_branch(worth_of_darker_way(scattering, branch.throughput, branch.eta_scale));
  branch.is_branch = true;
  const std::optional<BsdfSample> darker = one_way(scattering, false);
  if (darker && leave(i, branch, *darker)) {
    branch_of_[branch_count_] = i;
    branches_.emplace(branch_count_++, branch);
  }
  return one_way(scattering, true);
}

/// Goes on with the branches that were left, one of each sample.
bool PathBatch::take_up_branches() {
  int left = 0;
  std::uint32_t taken = 0;
  for (int b = 0; b < branch_count_; ++b) {
    const int i = branch_of_[b];
    if ((taken >> i & 1u) == 0) {
      taken |= 1u << i;
      paths_[i] = branches_[b];
      active_[active_count_++] = i;
    } else {
      branch_of_[left] = i;
      branches_.emplace(left++, branches_[b]);
    }
  }
  branch_count_ = left;
  return active_count_ > 0;
}

/// What the cache may know of the light that path i's vertex scatters.
std::optional<RadianceRecord> PathBatch::record_at(int i) const {
  const Path& path = paths_[i];
  const Vertex& vertex = vertices_[i];
  if (common_.cell_side == 0 || path.chain.pdf_bsdf == 0 || !may_bounce(i)) return std::nullopt;
  if (!vertex.scattering.is_lambertian() || vertex.scattering.albedo().is_black()) return std::nullopt;
  // The path's directions have to be spread over more than a cell.
  const Vec3 d = vertex.surface.position - path.chain.position;
  const float spread =
      length_squared(d) / (path.chain.pdf_bsdf * std::abs(dot(vertex.wo, vertex.surface.geometric_normal)));
  if (!(spread > square(kSpreadInCells * common_.cell_side))) return std::nullopt;
  const Vec3& normal = vertex.scattering.normal();
  const int depth = common_.settings.max_depth;
  return RadianceRecord{.position = vertex.surface.position,
                        .normal = dot(normal, vertex.wo) < 0 ? -normal : normal,
                        .turns = kNormalSteps,
                        .bounces_left = depth == kUnlimitedDepth ? depth : depth - path.depth};
}

/// Adds what the cache knows of the rest of path i.
bool PathBatch::is_known(int i) {
  if (!common_.cache || !records_.empty()) return false;
  const std::optional<RadianceRecord> record = record_at(i);
  if (!record) return false;
  const RadianceCache::Light* known = common_.cache->find(*record);
  if (known == nullptr) return false;
  const Spectrum light = known->radiance + known->caustics * paths_[i].caustics;
  radiance_of(i) += paths_[i].throughput * vertices_[i].scattering.albedo() * light;
  return true;
}

}  // namespace etendue
