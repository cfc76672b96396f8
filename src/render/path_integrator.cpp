#include "render/path_integrator.h"

#include <bit>

#include "math/frame.h"
#include "render/debug_integrators.h"
#include "render/dimensions.h"
#include "render/direct_light.h"
#include "render/vertex.h"
#include "render/volume_path_integrator.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

constexpr int kBatch = Geometry::kBatch;

/// Paths of fewer bounces than this are never ended by roulette, …
constexpr int kRouletteStart = 5;
/// … unless they passed straight through very many surfaces.
constexpr int kManySegments = 1000;
constexpr float kMaxSurvival = 0.99f;

/// Of chosen lights, at a path's first and second vertex that look for them, and at all others: the first count for
/// more of the picture than the rest of the path, the second are shared with neighbours.
constexpr int kLightSamples[] = {4, 2, 1};
constexpr int kMostLightSamples = 4;

/// Pixels along the side of a block whose paths are shared: its square is the most that share_paths takes.
constexpr int kReuseSide = 4;
static_assert(kReuseSide * kReuseSide <= std::min(kBatch, PixelBlock::kMost));

/// Samples of a pixel for which photons are traced anew and blocks of pixels lie differently: one batch, or as many as
/// small pictures need to make it worth while.
std::uint32_t usual_generation_size(const RenderSettings& settings) {
  constexpr std::uint64_t kFewestPixels = 1 << 14;
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  return static_cast<std::uint32_t>((kFewestPixels + pixels - 1) / pixels) * kBatch;
}

/// Whether to try a technique for light that bounces more than once.
bool uses(const RenderSettings& settings, Use technique) {
  if (settings.max_depth < 2 || technique == Use::off) return false;
  return settings.integrator == IntegratorKind::automatic ||
         (settings.integrator == IntegratorKind::path && technique == Use::on);
}

/// Pixels that share have as many samples; and denoisers expect them to know nothing of each other.
bool shares_paths(const RenderSettings& settings) {
  if (settings.adaptive || (settings.for_denoising && settings.reuse != Use::on)) return false;
  return uses(settings, settings.reuse);
}

}  // namespace

/// A path under way: the ray that leaves its last vertex, and what it is worth.
struct PathIntegrator::Path {
  Ray ray;
  Spectrum throughput{1};
  float pdf_bsdf = 0;     ///< of the ray's direction; 0: only this ray finds what it meets (camera, delta lobe)
  Receiver scattered_at;  ///< where that direction was chosen: the ray's origin, or before surfaces that it passed
                          ///< straight through
  float eta_scale =
      1;          ///< product of eta² along the path: what refraction did to the throughput is no reason to end it
  int depth = 0;  ///< bounces so far
  bool from_camera = true;  ///< has not been scattered yet
  int scatterings = 0;      ///< by anything but delta lobes
  float light_samples = 1;  ///< that the last of these vertices took of the lights
  SpecularChain chain;      ///< since the last vertex that looked for lights

  /// How far it is on the way to something that its neighbours can use.
  enum class Sharing { seeks_first, left_first, shares, keeps };
  Sharing sharing = Sharing::keeps;
  float inverse_survival = 1;  ///< of the last roulette
  Spectrum prefix{1};          ///< while it shares: its throughput before, which `throughput` then starts anew after
};

/// The paths of one call to estimate().
class PathIntegrator::Batch {
 public:
  /// `shared` is where the paths leave what others can use: one of each sample, or nothing.
  Batch(const PathIntegrator& integrator, int x, int y, std::uint32_t first, std::span<PixelSample> samples,
        std::span<SharedPath> shared)
      : self_(integrator),
        scene_(integrator.scene_),
        sampler_(integrator.settings_.sampler, integrator.settings_.seed, static_cast<std::uint32_t>(x),
                 static_cast<std::uint32_t>(y)),
        first_(first),
        samples_(samples),
        shared_(shared),
        count_(static_cast<int>(samples.size())) {
    start(x, y);
  }

  std::uint64_t run() {
    for (int bounce = 0; active_count_ > 0; ++bounce) {
      if (bounce > 0) intersect();
      if (self_.settings_.hide_emitters) look_behind_lights(bounce);
      arrive(bounce);
      if (!shared_.empty()) share();
      if (self_.photons_) gather_photons();
      if (self_.hemisphere_)
        sample_hemisphere(bounce);
      else
        sample_lights(bounce);
      scatter(bounce);
    }
    return rays_;
  }

 private:
  void start(int x, int y);
  void intersect();
  void look_behind_lights(int bounce);
  void arrive(int bounce);
  void share();
  void gather_photons();
  void sample_lights(int bounce);
  void sample_chosen_lights(int bounce);
  void sample_chosen_lights(int bounce, std::uint32_t seeking, int samples);
  void sample_light_for_all(int bounce, std::uint32_t light);
  void sample_hemisphere(int bounce);
  void leave_first(int i, const BsdfSample& sample);
  void scatter(int bounce);

  void see_infinity();
  void see_emission(int i);
  /// How many chosen lights the path's vertex asks.
  int light_samples(const Path& path) const { return self_.splits_ ? kLightSamples[std::min(path.scatterings, 2)] : 1; }
  /// Of path i's first among `samples` samples a path.
  std::uint64_t sample_number(int i, std::int64_t samples) const {
    return (std::uint64_t{first_} + static_cast<std::uint64_t>(i)) * static_cast<std::uint64_t>(samples);
  }
  void aim_at(std::uint32_t light);
  void aim(int i, const LightSample& sample, float density);
  void flush_shadow_rays();
  Spectrum transmittance(Ray ray, int most_surfaces);
  /// How many surfaces a shadow ray of path i may pass straight through. Where passing is a bounce, light of no size is
  /// not found by it, as in Mitsuba's path tracer.
  int most_surfaces_passed(int i, bool is_delta) const {
    if (!self_.settings_.null_counts_as_bounce) return kUnlimitedDepth;
    return is_delta ? 0 : self_.settings_.max_depth - paths_[i].depth - 1;
  }
  Spectrum emission_along(Ray ray);
  /// What light found by path i is added to.
  Spectrum& radiance_of(int i) {
    return paths_[i].sharing == Path::Sharing::shares ? shared_[i].radiance : samples_[i].radiance;
  }
  bool counts_emission(const Path& path) const { return !self_.hemisphere_ || path.pdf_bsdf == 0; }
  /// Whether a path that goes straight on uses up nothing.
  bool may_pass_freely(const Vertex& vertex) const {
    return !self_.settings_.null_counts_as_bounce && !vertex.scattering.straight_through().is_black();
  }
  /// Whether path i may be scattered once more. Passing straight on is another matter.
  bool may_bounce(int i) const { return paths_[i].depth < self_.settings_.max_depth; }
  /// Whether path i looks for lights.
  bool seeks_lights(int i) const { return may_bounce(i) && !vertices_[i].scattering.is_delta(); }

  const PathIntegrator& self_;
  const RenderScene::Data& scene_;
  PixelSampler sampler_;
  std::uint32_t first_;
  std::span<PixelSample> samples_;
  std::span<SharedPath> shared_;
  int count_;
  std::uint64_t rays_ = 0;

  Path paths_[kBatch];
  Vertex vertices_[kBatch];
  RayHit hits_[kBatch];
  int active_[kBatch];
  int active_count_ = 0;

  /// What is to be asked of one light, so that all its answers can be found together.
  struct Aims {
    int count = 0;
    int path[kBatch];
    Point3 from[kBatch];
    Vec2 u[kBatch];
    std::uint32_t part[kBatch];
    float density[kBatch];  ///< how many samples a vertex is expected to take of that part

    void add(int i, const Point3& lit, const Vec2& position, std::uint32_t which, float expected) {
      path[count] = i;
      from[count] = lit;
      u[count] = position;
      part[count] = which;
      density[count++] = expected;
    }
  };
  Aims aims_;

  Ray shadow_rays_[kBatch];
  Spectrum shadow_radiance_[kBatch];
  int shadow_path_[kBatch];
  int shadow_may_pass_[kBatch];  ///< so many surfaces
  int shadow_count_ = 0;
};

void PathIntegrator::Batch::start(int x, int y) {
  Ray rays[kBatch];
  self_.camera_rays_.generate(sampler_, x, y, first_, std::span(rays, count_), samples_);
  scene_.geometry.intersect_coherent(std::span<const Ray>(rays, count_), std::span(hits_, count_));
  rays_ += count_;
  for (int i = 0; i < count_; ++i) {
    paths_[i].ray = rays[i];
    if (!shared_.empty()) paths_[i].sharing = Path::Sharing::seeks_first;
    active_[active_count_++] = i;
  }
}

void PathIntegrator::Batch::intersect() {
  for (int a = 0; a < active_count_; ++a) hits_[active_[a]] = scene_.geometry.intersect(paths_[active_[a]].ray);
  rays_ += active_count_;
}

/// The camera sees neither the lights that it is not to see nor their shapes. Where passing a surface is a bounce, what
/// lies behind one is not seen directly.
void PathIntegrator::Batch::look_behind_lights(int bounce) {
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (!paths_[i].from_camera || (bounce > 0 && self_.settings_.null_counts_as_bounce)) continue;
    const Meeting behind = behind_lights(scene_, paths_[i].ray, hits_[i]);
    paths_[i].ray = behind.ray;
    hits_[i] = behind.hit;
    rays_ += static_cast<std::uint64_t>(behind.rays);
  }
}

/// What the paths that met nothing see.
void PathIntegrator::Batch::see_infinity() {
  if (scene_.infinite_lights.empty()) return;
  int path[kBatch];
  Vec3 wi[kBatch];
  std::size_t n = 0;
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (hits_[i].found() || !counts_emission(paths_[i])) continue;
    if (paths_[i].from_camera && self_.settings_.hide_emitters) continue;
    path[n] = i;
    wi[n++] = paths_[i].ray.direction;
  }
  if (n == 0) return;
  for (const std::uint32_t light : scene_.infinite_lights) {
    InfiniteView views[kBatch];
    look_at_infinity(scene_.lights[light], std::span<const Vec3>(wi, n), std::span(views, n));
    for (std::size_t j = 0; j < n; ++j) {
      const Path& p = paths_[path[j]];
      float weight = 1;
      if (p.pdf_bsdf > 0)
        weight = mis_weight(p.pdf_bsdf, views[j].pdf * p.light_samples * self_.light_density(p.scattered_at, light, 0));
      else if (self_.photons_)
        weight = self_.photons_->weight_of_found(p.chain, light, p.ray.origin, wi[j], views[j].pdf);
      radiance_of(path[j]) += p.throughput * views[j].radiance * weight;
    }
  }
}

void PathIntegrator::Batch::see_emission(int i) {
  const Path& path = paths_[i];
  const Vertex& vertex = vertices_[i];
  if (!counts_emission(path)) return;
  float weight = 1;
  if (path.pdf_bsdf > 0) {
    const Light& light = scene_.lights[vertex.light];
    const float pdf = light_pdf(light, path.scattered_at.position, vertex.light_hit);
    const float density =
        path.light_samples * self_.light_density(path.scattered_at, vertex.light, part_at(light, vertex.light_hit));
    weight = mis_weight(path.pdf_bsdf, pdf * density);
  } else if (self_.photons_) {
    weight = self_.photons_->weight_of_found(path.chain, vertex.light, vertex.light_hit, vertex.wo);
  }
  radiance_of(i) += path.throughput * vertex.emission * weight;
}

void PathIntegrator::Batch::arrive(int bounce) {
  see_infinity();
  int kept = 0;
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (!hits_[i].found()) continue;
    Vertex& vertex = vertices_[i];
    ::new (&vertex) Vertex(find_vertex(scene_, paths_[i].ray, hits_[i]));  // made where it stays: it is large
    if (vertex.light != kNone) see_emission(i);
    if (bounce == 0) {
      self_.camera_rays_.describe(paths_[i].ray, vertex.surface, samples_[i]);
      samples_[i].albedo = vertex.scattering.albedo();
    }
    if (may_bounce(i) || may_pass_freely(vertex)) active_[kept++] = i;
  }
  active_count_ = kept;
}

/// Leaves the first vertex that looks for lights and, if it is Lambertian, the next one to other pixels. From there on
/// what the path finds is theirs too.
void PathIntegrator::Batch::share() {
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

/// Light that comes to the paths' vertices by way of mirrors and smooth glass alone.
void PathIntegrator::Batch::gather_photons() {
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (!seeks_lights(i)) continue;
    radiance_of(i) +=
        paths_[i].throughput * self_.photons_->radiance(vertices_[i], self_.settings_.max_depth - paths_[i].depth - 1,
                                                        first_ + static_cast<std::uint32_t>(i));
  }
}

void PathIntegrator::Batch::aim_at(std::uint32_t light) {
  const auto n = static_cast<std::size_t>(aims_.count);
  std::optional<LightSample> samples[kBatch];
  sample_light(scene_.lights[light], std::span<const std::uint32_t>(aims_.part, n),
               std::span<const Point3>(aims_.from, n), std::span<const Vec2>(aims_.u, n), std::span(samples, n));
  for (std::size_t j = 0; j < n; ++j)
    if (samples[j]) aim(aims_.path[j], *samples[j], aims_.density[j]);
  aims_.count = 0;
}

/// Prepares the shadow ray of path i to a point of a light; it is traced when a packet is full.
void PathIntegrator::Batch::aim(int i, const LightSample& sample, float density) {
  const Vertex& vertex = vertices_[i];
  const Vec3& ng = vertex.surface.geometric_normal;
  const bool same_side = dot(sample.wi, ng) * dot(vertex.wo, ng) > 0;
  if (!same_side && !vertex.scattering.transmits()) return;
  const BsdfEval eval = vertex.scattering.eval(sample.wi);
  if (eval.f_cos.is_black()) return;
  const float pdf = sample.pdf * density;
  const float weight = sample.is_delta ? 1.0f : mis_weight(pdf, eval.pdf);
  shadow_radiance_[shadow_count_] = paths_[i].throughput * eval.f_cos * sample.radiance * (weight / pdf);
  shadow_rays_[shadow_count_] = shadow_ray(offset_origin(vertex.surface, sample.wi), vertex.surface.position, sample);
  shadow_path_[shadow_count_] = i;
  shadow_may_pass_[shadow_count_] = most_surfaces_passed(i, sample.is_delta);
  if (++shadow_count_ == kBatch) flush_shadow_rays();
}

/// Share of light that gets along `ray` straight through at most so many surfaces.
Spectrum PathIntegrator::Batch::transmittance(Ray ray, int most_surfaces) {
  Spectrum share(1);
  while (true) {
    const RayHit hit = scene_.geometry.intersect(ray);
    ++rays_;
    if (!hit.found()) return share;
    if (most_surfaces-- == 0) return Spectrum(0);
    share *= pass_through(scene_, ray, hit);
    if (share.is_black()) return share;
    ray = straight_on(scene_, ray, hit);
  }
}

void PathIntegrator::Batch::flush_shadow_rays() {
  if (shadow_count_ == 0) return;
  const std::uint32_t blocked = scene_.geometry.occluded(std::span<const Ray>(shadow_rays_, shadow_count_));
  for (int s = 0; s < shadow_count_; ++s) {
    const int i = shadow_path_[s];
    if ((blocked >> s & 1u) == 0)
      radiance_of(i) += shadow_radiance_[s];
    else if (scene_.may_pass && shadow_may_pass_[s] > 0)
      radiance_of(i) += shadow_radiance_[s] * transmittance(shadow_rays_[s], shadow_may_pass_[s]);
  }
  rays_ += shadow_count_;
  shadow_count_ = 0;
}

void PathIntegrator::Batch::sample_lights(int bounce) {
  if (scene_.lights.empty()) return;
  if (self_.every_light_)
    for (std::uint32_t light = 0; light < scene_.lights.size(); ++light) sample_light_for_all(bounce, light);
  else
    sample_chosen_lights(bounce);
  flush_shadow_rays();
}

// Points on lights are chosen for several paths in one loop before anything else is asked about them: while one waits
// for the memory of an environment map, so do the next.

void PathIntegrator::Batch::sample_light_for_all(int bounce, std::uint32_t light) {
  const int samples = samples_of_light(scene_, self_.settings_.light_samples, light);
  float x[kBatch], y[kBatch], part[kBatch] = {}, unused[kBatch];
  // Sample j of path i is number (first + i) · samples + j of one sequence: well spread over the light across all of
  // them.
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (!seeks_lights(i)) continue;
    for (std::int64_t done = 0; done < samples; done += kBatch) {
      const auto n = static_cast<int>(std::min<std::int64_t>(kBatch, samples - done));
      const std::uint64_t index = sample_number(i, samples) + done;
      sampler_.points(dimension::at(bounce, dimension::position(light)), index, n, x, y);
      if (part_count(scene_.lights[light]) > 1)
        sampler_.points(dimension::at(bounce, dimension::part(light)), index, n, part, unused);
      for (int j = 0; j < n; ++j) {
        const PartChoice chosen = choose_part(scene_.lights[light], part[j]);
        aims_.add(i, vertices_[i].surface.position, {x[j], y[j]}, chosen.part,
                  static_cast<float>(samples) * chosen.probability);
      }
      aim_at(light);
    }
  }
}

/// All paths that take as many samples here do so together.
void PathIntegrator::Batch::sample_chosen_lights(int bounce) {
  for (const int samples : {kLightSamples[0], kLightSamples[1], 1}) {
    std::uint32_t seeking = 0;
    for (int a = 0; a < active_count_; ++a)
      if (seeks_lights(active_[a]) && light_samples(paths_[active_[a]]) == samples) seeking |= 1u << active_[a];
    if (seeking != 0) sample_chosen_lights(bounce, seeking, samples);
    if (samples == 1) break;
  }
}

/// Bit i of `seeking` is set for the paths meant.
void PathIntegrator::Batch::sample_chosen_lights(int bounce, std::uint32_t seeking, int samples) {
  constexpr int kMost = kBatch * kMostLightSamples;
  float choice[kMost] = {}, more[kMost] = {}, x[kMost], y[kMost];
  const std::uint64_t index = sample_number(0, samples);
  if (!scene_.light_choice.is_certain())
    sampler_.points(dimension::at(bounce, dimension::kLightChoice), index, count_ * samples, choice, more);
  sampler_.points(dimension::at(bounce, dimension::position(0)), index, count_ * samples, x, y);
  for (int k = 0; k < samples; ++k) {
    Receiver at[kBatch];
    double u[kBatch];
    std::optional<LightChooser::Choice> chosen[kBatch];
    int path[kBatch];
    std::size_t n = 0;
    for (std::uint32_t left = seeking; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      at[n] = receiver(vertices_[i]);
      u[n] = fine_uniform({choice[i * samples + k], more[i * samples + k]});
      path[n++] = i;
    }
    scene_.light_choice.sample(std::span<const Receiver>(at, n), std::span<const double>(u, n), std::span(chosen, n));
    std::uint32_t waiting = 0;  // bit j: the j-th of them has a light still to be asked
    for (std::size_t j = 0; j < n; ++j) waiting |= chosen[j] ? 1u << j : 0u;
    while (waiting != 0) {
      const std::uint32_t light = chosen[std::countr_zero(waiting)]->light;
      for (std::size_t j = 0; j < n; ++j) {
        if ((waiting >> j & 1u) == 0 || chosen[j]->light != light) continue;
        const int i = path[j], at_sample = i * samples + k;
        aims_.add(i, vertices_[i].surface.position, {x[at_sample], y[at_sample]}, chosen[j]->part,
                  static_cast<float>(samples) * chosen[j]->probability);
        waiting &= ~(1u << j);
      }
      aim_at(light);
    }
  }
}

Spectrum PathIntegrator::Batch::emission_along(Ray ray) {
  Spectrum radiance, share(1);
  while (!share.is_black()) {
    const RayHit hit = scene_.geometry.intersect(ray);
    ++rays_;
    if (!hit.found()) {
      for (const std::uint32_t light : scene_.infinite_lights)
        radiance += look_at_infinity(scene_.lights[light], ray.direction).radiance * share;
      break;
    }
    radiance += find_vertex(scene_, ray, hit).emission * share;
    share *= pass_through(scene_, ray, hit);
    ray = straight_on(scene_, ray, hit);
  }
  return radiance;
}

void PathIntegrator::Batch::sample_hemisphere(int bounce) {
  const std::int64_t n = static_cast<std::int64_t>(std::max(1, self_.settings_.light_samples)) *
                         static_cast<std::int64_t>(std::max<std::size_t>(1, scene_.lights.size()));
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    const Vertex& vertex = vertices_[i];
    if (!seeks_lights(i)) continue;
    const Vec3& normal = vertex.scattering.normal();
    const Frame frame = Frame::from_normal(dot(normal, vertex.wo) < 0 ? -normal : normal);
    for (std::int64_t j = 0; j < n; ++j) {
      float u, v;
      sampler_.points(dimension::at(bounce, dimension::position(0)), sample_number(i, n) + j, 1, &u, &v);
      const Vec3 local = sample_hemisphere_uniform({u, v});
      const Vec3 wi = frame.to_world(local);
      const BsdfEval eval = vertex.scattering.eval(wi);
      if (eval.f_cos.is_black()) continue;
      const Spectrum radiance = emission_along({offset_origin(vertex.surface, wi), wi});
      samples_[i].radiance +=
          paths_[i].throughput * eval.f_cos * radiance * (1 / (hemisphere_uniform_pdf(local) * static_cast<float>(n)));
    }
  }
}

/// Path i is scattered by the vertex that its neighbours may share: off to the next one, unless by a delta lobe.
void PathIntegrator::Batch::leave_first(int i, const BsdfSample& sample) {
  paths_[i].sharing = Path::Sharing::keeps;
  if (sample.is_delta()) return;
  paths_[i].sharing = Path::Sharing::left_first;
  shared_[i].f_cos = sample.weight * sample.pdf;
  shared_[i].pdf = sample.pdf;
}

/// Every path goes on into a direction that its BSDF chooses, or straight through a surface that is not there, or ends.
void PathIntegrator::Batch::scatter(int bounce) {
  float u[kBatch], v[kBatch], choice[kBatch], roulette[kBatch];
  sampler_.points(dimension::at(bounce, dimension::kDirection), first_, count_, u, v);
  sampler_.points(dimension::at(bounce, dimension::kLobeAndRoulette), first_, count_, choice, roulette);
  int kept = 0;
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    const Vertex& vertex = vertices_[i];
    Path& path = paths_[i];
    const std::optional<BsdfSample> sample = vertex.scattering.sample({u[i], v[i]}, choice[i]);
    if (!sample) continue;
    if (sample->lobe == Lobe::straight) {
      path.depth += self_.settings_.null_counts_as_bounce ? 1 : 0;
    } else {
      if (!may_bounce(i)) continue;
      path.depth += 1;
      path.pdf_bsdf = sample->pdf;
      path.scattered_at = receiver(vertex);
      path.from_camera = false;
      if (path.sharing == Path::Sharing::seeks_first && !vertex.scattering.is_delta()) leave_first(i, *sample);
      if (!sample->is_delta()) {
        path.light_samples = static_cast<float>(light_samples(path));
        ++path.scatterings;
      }
      if (sample->is_delta())
        path.chain.bounce(vertex, sample->wi, sample->eta);
      else
        path.chain = {sample->pdf, std::abs(dot(sample->wi, vertex.surface.geometric_normal)), vertex.surface.position};
    }
    path.throughput *= sample->weight;
    path.eta_scale *= square(sample->eta);
    path.inverse_survival = 1;
    if (path.depth >= kRouletteStart || bounce >= kManySegments) {
      const float survival = std::min((path.throughput * path.prefix).max() * path.eta_scale, kMaxSurvival);
      if (roulette[i] >= survival) continue;
      path.inverse_survival = 1 / survival;
      path.throughput *= path.inverse_survival;
    }
    if (path.throughput.is_black()) continue;
    path.ray = {offset_origin(vertex.surface, sample->wi), sample->wi};
    active_[kept++] = i;
  }
  active_count_ = kept;
}

PathIntegrator::PathIntegrator(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings)
    : scene_(scene),
      settings_(settings),
      camera_rays_(scene, camera, settings),
      every_light_(settings.light_samples > 0),
      hemisphere_(settings.integrator == IntegratorKind::hemisphere),
      splits_(settings.integrator == IntegratorKind::automatic && !every_light_),
      reuse_(shares_paths(settings) && !scene.may_pass && !scene.measured) {
  if (settings.integrator == IntegratorKind::direct) settings_.max_depth = std::min(settings.max_depth, 1);
  generation_size_ = usual_generation_size(settings_);
  // Photons do not count what they pass straight through.
  if (!uses(settings, settings.photons) || (scene.may_pass && settings.null_counts_as_bounce)) return;
  photons_.emplace(scene, camera, settings_, generation_size_);
  if (!photons_->possible()) photons_.reset();
}

std::string_view PathIntegrator::promise() const {
  return photons_ ? "consistent: photons blur caustics, the less the more samples" : "unbiased";
}

std::uint32_t PathIntegrator::generation_size() const {
  if (photons_ || reuse_) return generation_size_;
  return Integrator::generation_size();
}

std::uint64_t PathIntegrator::prepare(std::uint32_t generation) {
  return photons_ ? photons_->trace(generation) : 0;
}

float PathIntegrator::light_density(const Receiver& at, std::uint32_t light, std::uint32_t part) const {
  return etendue::light_density(scene_, settings_.light_samples, at, light, part);
}

int PathIntegrator::block_side() const {
  return reuse_ ? kReuseSide : 1;
}

std::uint64_t PathIntegrator::estimate(const PixelBlock& block, std::uint32_t first, int count,
                                       std::span<PixelSample> samples) const {
  std::vector<SharedPath> shared(reuse_ ? samples.size() : 0);
  std::uint64_t rays = 0;
  for (int pixel = 0; pixel < block.size(); ++pixel) {
    const auto begin = static_cast<std::size_t>(pixel) * count;
    rays += Batch(*this, block.x + pixel % block.width, block.y + pixel / block.width, first,
                  samples.subspan(begin, count), reuse_ ? std::span(shared).subspan(begin, count) : std::span(shared))
                .run();
  }
  return reuse_ ? rays + share(shared, block.size(), count, samples) : rays;
}

/// Samples of the same number share their paths.
std::uint64_t PathIntegrator::share(std::span<const SharedPath> paths, int pixels, int count,
                                    std::span<PixelSample> samples) const {
  const SharedPath* neighbours[Geometry::kBatch];
  PixelSample* targets[Geometry::kBatch];
  const auto n = static_cast<std::size_t>(pixels);
  std::uint64_t rays = 0;
  for (int i = 0; i < count; ++i) {
    for (int pixel = 0; pixel < pixels; ++pixel) {
      neighbours[pixel] = &paths[pixel * count + i];
      targets[pixel] = &samples[pixel * count + i];
    }
    rays += share_paths(scene_.geometry, std::span(neighbours, n), std::span(targets, n));
  }
  return rays;
}

std::unique_ptr<Integrator> make_integrator(const RenderScene::Data& scene, const Camera& camera,
                                            const RenderSettings& settings) {
  switch (settings.integrator) {
    case IntegratorKind::automatic:
    case IntegratorKind::path:
    case IntegratorKind::direct:
    case IntegratorKind::hemisphere:
      if (!scene.media.empty()) return std::make_unique<VolumePathIntegrator>(scene, camera, settings);
      return std::make_unique<PathIntegrator>(scene, camera, settings);
    case IntegratorKind::normals:
    case IntegratorKind::albedo:
    case IntegratorKind::ao:
      break;
  }
  return std::make_unique<DebugIntegrator>(scene, camera, settings);
}

}  // namespace etendue
