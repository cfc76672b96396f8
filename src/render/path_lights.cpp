#include <bit>
#include <utility>

#include "math/frame.h"
#include "render/dimensions.h"
#include "render/path_batch.h"
#include "sampling/warp.h"

/// How a batch's paths find light.
namespace etendue {
namespace {

/// Of chosen lights, at a path's first and second vertex that look for them, and at all others: the first count for
/// more of the picture than the rest of the path, the second are shared with neighbours. Branches begin with one.
constexpr int kLightSamples[] = {4, 2, 1};
constexpr int kMostSamples = PathCommons::kMostLooks;
static_assert(kMostSamples >= kLightSamples[0]);

}  // namespace

int PathBatch::light_samples(int i, const Path& path) const {
  if (!common_.splits || (path.is_branch && path.scatterings == 0)) return 1;
  const int all = std::max(kLightSamples[std::min(path.scatterings, 2)], bsdf_samples(i));
  return common_.every_light ? std::max(1, all / static_cast<int>(scene_.lights.size())) : all;
}

/// What the paths that met nothing see.
void PathBatch::see_infinity() {
  if (scene_.infinite_lights.empty()) return;
  int path[kBatch];
  Vec3 wi[kBatch];
  std::size_t n = 0;
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (hits_[i].found() || !counts_emission(paths_[i])) continue;
    if (paths_[i].sharing == Path::Sharing::seeks_record) continue;
    if (paths_[i].from_camera && common_.settings.hide_emitters) continue;
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
        weight = bsdf_weight(p, light, 0, views[j].pdf) * gleam_weight(p, light, views[j].pdf);
      else if (common_.photons && p.chain.is_shared())
        weight = p.caustics * common_.photons->weight_of_found(p.chain, light, p.ray.origin, wi[j], views[j].pdf);
      (p.chain.is_shared() ? caustics_of(path[j]) : radiance_of(path[j])) += p.throughput * views[j].radiance * weight;
    }
  }
}

/// Weight of a light that the path's last direction found, which light samples find with density `pdf`.
float PathBatch::bsdf_weight(const Path& path, std::uint32_t light, std::uint32_t part, float pdf) const {
  const float density =
      path.light_samples * light_density(scene_, common_.settings.light_samples, path.scattered_at, light, part);
  return mis_weight(path.bsdf_samples * path.pdf_bsdf, pdf * density) / path.bsdf_samples;
}

/// The same of the light that it met at a surface.
float PathBatch::bsdf_weight(const Path& path, const Vertex& met) const {
  const Light& light = scene_.lights[met.light];
  return bsdf_weight(path, met.light, part_at(light, met.light_hit),
                     light_pdf(light, path.scattered_at.position, met.light_hit));
}

/// Weight of what the path sees at infinity, for photons may have found it too.
float PathBatch::gleam_weight(const Path& path, std::uint32_t light, float pdf) const {
  if (path.gleam.spread == 0) return 1;
  return common_.photons->weight_of_gleam(path.gleam, path.scattered_at, light, path.ray.direction, pdf, path.pdf_bsdf);
}

void PathBatch::see_emission(int i) {
  const Path& path = paths_[i];
  const Vertex& vertex = vertices_[i];
  if (!counts_emission(path)) return;
  float weight = 1;
  if (path.pdf_bsdf > 0) {
    weight = bsdf_weight(path, vertex);
  } else if (common_.photons && path.chain.is_shared()) {
    weight = path.caustics * common_.photons->weight_of_found(path.chain, vertex.light, vertex.light_hit, vertex.wo);
  } else if (common_.camera_chains && path.scatterings == 0 && path.is_among_chains) {
    weight = common_.camera_chains->weight_of_found(
        x_, y_, sampler_.point(dimension::kFilm, first_ + static_cast<std::uint32_t>(i)), path.depth);
  }
  (path.chain.is_shared() ? caustics_of(i) : radiance_of(i)) += path.throughput * vertex.emission * weight;
}

void PathBatch::aim_at(std::uint32_t light) {
  const auto n = static_cast<std::size_t>(aims_.count);
  sample_light(scene_.lights[light], std::span<const std::uint32_t>(aims_.part, n),
               std::span<const Point3>(aims_.from, n), std::span<const Vec2>(aims_.u, n),
               [&](std::size_t j, const LightSample& sample) { aim(aims_.path[j], light, sample, aims_.density[j]); });
  aims_.count = 0;
}

/// Prepares the shadow ray of path i to a point of a light; it is traced when a packet is full.
void PathBatch::aim(int i, std::uint32_t light, const LightSample& sample, float density) {
  const Vertex& vertex = vertices_[i];
  const Vec3& ng = vertex.surface.geometric_normal;
  const bool same_side = dot(sample.wi, ng) * dot(vertex.wo, ng) > 0;
  if (!same_side && !vertex.scattering.transmits()) return;
  const BsdfEval eval = vertex.scattering.eval(sample.wi);
  if (eval.f_cos.is_black()) return;
  const float pdf = sample.pdf * density;
  float weight = sample.is_delta ? 1.0f : mis_weight(pdf, static_cast<float>(bsdf_samples(i)) * eval.pdf);
  if (common_.photons && !sample.is_delta && is_infinite(scene_.lights[light]))
    weight *= common_.photons->weight_of_gleam(common_.photons->gleam(paths_[i].chain, vertex, sample.wi), asking(i),
                                               light, sample.wi, sample.pdf, eval.pdf);
  shadow_radiance_[shadow_count_] = paths_[i].throughput * eval.f_cos * sample.radiance * (weight / pdf);
  shadow_rays_[shadow_count_] = shadow_ray(offset_origin(vertex.surface, sample.wi), vertex.surface.position, sample);
  shadow_path_[shadow_count_] = i;
  shadow_may_pass_[shadow_count_] = most_surfaces_passed(i, sample.is_delta);
  if (++shadow_count_ == kBatch) flush_shadow_rays();
}

/// Share of light that gets along `ray` straight through at most so many surfaces.
Spectrum PathBatch::transmittance(Ray ray, int most_surfaces) {
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

void PathBatch::flush_shadow_rays() {
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

/// All paths that take as many samples of the lights do so together.
void PathBatch::sample_lights(int bounce) {
  if (scene_.lights.empty()) return;
  std::uint32_t left = 0;
  for (int a = 0; a < active_count_; ++a)
    if (seeks_lights(active_[a])) left |= 1u << active_[a];
  while (left != 0) {
    const auto samples_of = [this](int i) { return light_samples(i, paths_[i]); };
    const int samples = samples_of(std::countr_zero(left));
    std::uint32_t seeking = 0;
    for (std::uint32_t rest = left; rest != 0; rest &= rest - 1)
      if (samples_of(std::countr_zero(rest)) == samples) seeking |= rest & -rest;
    if (common_.every_light)
      for (std::uint32_t light = 0; light < scene_.lights.size(); ++light)
        sample_given_light(bounce, light, seeking,
                           samples_of_light(scene_, samples * common_.settings.light_samples, light));
    else if (scene_.light_choice.is_certain())
      sample_given_light(bounce, 0, seeking, samples);
    else
      sample_chosen_lights(bounce, seeking, samples);
    left &= ~seeking;
  }
  flush_shadow_rays();
}

// Points on lights are chosen for several paths in one loop before anything else is asked about them: while one waits
// for the memory of an environment map, so do the next.

/// Bit i of `seeking` is set for the paths meant. Sample j of path i is number (first + i) · samples + j of one
/// sequence: well spread over the light across all of them.
void PathBatch::sample_given_light(int bounce, std::uint32_t light, std::uint32_t seeking, int samples) {
  constexpr int kMost = kBatch * kMostSamples;
  float x[kMost], y[kMost], part[kMost], unused[kMostSamples];
  const int together = std::min(samples, kMostSamples);  // of each path
  const bool has_parts = part_count(scene_.lights[light]) > 1;
  const std::uint64_t position = dimension::at(bounce, dimension::position(light));
  for (std::int64_t done = 0; done < samples; done += together) {
    const auto n = static_cast<int>(std::min<std::int64_t>(together, samples - done));
    if (n == samples) sampler_.points(position, sample_number(0, samples), count_ * n, x, y, n);
    for (std::uint32_t left = seeking; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      const std::uint64_t index = sample_number(i, samples) + static_cast<std::uint64_t>(done);
      const std::ptrdiff_t own = std::ptrdiff_t{i} * n;
      if (n < samples) sampler_.points(position, index, n, x + own, y + own, samples);
      if (has_parts)
        sampler_.points(dimension::at(bounce, dimension::part(light)), index, n, part + own, unused, samples);
    }
    for (int k = 0; k < n; ++k) {
      for (std::uint32_t left = seeking; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left), at_sample = i * n + k;
        const PartChoice chosen = has_parts ? choose_part(scene_.lights[light], part[at_sample]) : PartChoice{};
        aims_.add(i, vertices_[i].surface.position, {x[at_sample], y[at_sample]}, chosen.part,
                  static_cast<float>(samples) * chosen.probability);
      }
      aim_at(light);
    }
  }
}

/// Bit i of `seeking` is set for the paths meant.
void PathBatch::sample_chosen_lights(int bounce, std::uint32_t seeking, int samples) {
  constexpr int kMost = kBatch * kMostSamples;
  float choice[kMost], more[kMost], x[kMost], y[kMost];
  const std::uint64_t index = sample_number(0, samples);
  sampler_.points(dimension::at(bounce, dimension::kLightChoice), index, count_ * samples, choice, more, samples);
  sampler_.points(dimension::at(bounce, dimension::position(0)), index, count_ * samples, x, y, samples);
  Receiver at[kBatch];
  int path[kBatch];
  std::size_t n = 0;
  for (std::uint32_t left = seeking; left != 0; left &= left - 1) {
    path[n] = std::countr_zero(left);
    at[n] = asking(path[n]);
    ++n;
  }
  for (int k = 0; k < samples; ++k) {
    double u[kBatch];
    std::optional<LightChooser::Choice> chosen[kBatch];
    for (std::size_t j = 0; j < n; ++j)
      u[j] = fine_uniform({choice[path[j] * samples + k], more[path[j] * samples + k]});
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

/// How many directions of its BSDF path i's vertex takes to look for lights: those of surfaces that gleam are more
/// worth it than others.
int PathBatch::bsdf_samples(int i) const {
  return paths_[i].scatterings == 0 && !vertices_[i].scattering.is_lambertian() ? common_.looks : 1;
}

/// The first of a vertex' directions is the one that the path takes.
void PathBatch::look_for_lights(int bounce) {
  std::uint32_t looking = 0;
  for (int a = 0; a < active_count_; ++a)
    if (seeks_lights(active_[a]) && bsdf_samples(active_[a]) > 1) looking |= 1u << active_[a];
  if (looking == 0) return;
  constexpr int kMost = kBatch * (kMostSamples - 1);
  float u[kMost], v[kMost], choice[kMost], unused[kMost];
  const int more = common_.looks - 1;
  const std::uint64_t index = sample_number(0, more);
  sampler_.points(dimension::at(bounce, dimension::kMoreDirections), index, count_ * more, u, v, more);
  sampler_.points(dimension::at(bounce, dimension::kMoreLobes), index, count_ * more, choice, unused, more);
  Look looks[kBatch];
  int n = 0;
  for (; looking != 0; looking &= looking - 1) {
    const int i = std::countr_zero(looking);
    for (int k = i * more; k < (i + 1) * more; ++k) {
      const std::optional<BsdfSample> sample = vertices_[i].scattering.sample({u[k], v[k]}, choice[k]);
      if (!sample || sample->is_delta()) continue;
      looks[n] = {i, paths_[i]};
      looks[n].from.sharing = Path::Sharing::keeps;
      if (leave(i, looks[n].from, *sample)) ++n;
      if (n == kBatch) flush_looks(std::span(looks, std::exchange(n, 0)));
    }
  }
  flush_looks(std::span(looks, n));
}

void PathBatch::flush_looks(std::span<const Look> looks) {
  Ray rays[kBatch];
  RayHit hits[kBatch];
  for (std::size_t j = 0; j < looks.size(); ++j) rays[j] = looks[j].from.ray;
  scene_.geometry.intersect_coherent(std::span<const Ray>(rays, looks.size()), std::span(hits, looks.size()));
  rays_ += looks.size();
  for (std::size_t j = 0; j < looks.size(); ++j) {
    const Path& path = looks[j].from;
    Spectrum& radiance = radiance_of(looks[j].path);
    if (!hits[j].found()) {
      for (const std::uint32_t light : scene_.infinite_lights) {
        const InfiniteView view = look_at_infinity(scene_.lights[light], rays[j].direction);
        radiance += path.throughput * view.radiance * bsdf_weight(path, light, 0, view.pdf);
      }
    } else if (scene_.shapes[hits[j].shape].light != kNone) {
      const Vertex vertex(scene_, rays[j], hits[j]);
      if (vertex.light != kNone) radiance += path.throughput * vertex.emission * bsdf_weight(path, vertex);
    }
  }
}

Spectrum PathBatch::emission_along(Ray ray) {
  Spectrum radiance, share(1);
  while (!share.is_black()) {
    const RayHit hit = scene_.geometry.intersect(ray);
    ++rays_;
    if (!hit.found()) {
      for (const std::uint32_t light : scene_.infinite_lights)
        radiance += look_at_infinity(scene_.lights[light], ray.direction).radiance * share;
      break;
    }
    radiance += Vertex(scene_, ray, hit).emission * share;
    share *= pass_through(scene_, ray, hit);
    ray = straight_on(scene_, ray, hit);
  }
  return radiance;
}

void PathBatch::sample_hemisphere(int bounce) {
  const std::int64_t n = static_cast<std::int64_t>(std::max(1, common_.settings.light_samples)) *
                         static_cast<std::int64_t>(std::max<std::size_t>(1, scene_.lights.size()));
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    const Vertex& vertex = vertices_[i];
    if (!seeks_lights(i)) continue;
    const Vec3& normal = vertex.scattering.normal();
    const Frame frame = Frame::from_normal(dot(normal, vertex.wo) < 0 ? -normal : normal);
    for (std::int64_t j = 0; j < n; ++j) {
      float u, v;
      sampler_.points(dimension::at(bounce, dimension::position(0)), sample_number(i, n) + j, 1, &u, &v,
                      static_cast<int>(n));
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

}  // namespace etendue
