#include "render/path_integrator.h"

#include "math/frame.h"
#include "render/debug_integrators.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

constexpr int kBatch = Geometry::kBatch;

/// Paths shorter than this are never ended by roulette.
constexpr int kRouletteStart = 5;
constexpr float kMaxSurvival = 0.99f;

/// Power heuristic with exponent 2 (Veach 1997, eq. 9.13); densities already count the samples of each technique.
float mis_weight(float pdf, float other_pdf) {
  return 1 / (1 + square(other_pdf / pdf));
}

/// From a point to what it sampled: ends before a light's own surface by that point's rounding error and that of the ray.
Ray shadow_ray(const Point3& from, const LightSample& sample) {
  if (std::isinf(sample.distance)) return {from, sample.wi};
  const float error = sample.error + kRelativeError * max_abs_component(from);
  const Vec3 d = sample.wi * sample.distance + sample.normal * error;
  const float distance = length(d);
  return {from, d * (1 / distance), 0, distance};
}

}  // namespace

void CameraRays::generate(const PixelSampler& sampler, int x, int y, std::uint32_t first, std::span<Ray> rays) const {
  const int count = static_cast<int>(rays.size());
  float fu[kBatch], fv[kBatch], lu[kBatch], lv[kBatch];
  sampler.points(dimension::kFilm, first, count, fu, fv);
  if (camera_.lens_radius > 0) sampler.points(dimension::kLens, first, count, lu, lv);
  for (int i = 0; i < count; ++i) {
    const Vec2 film((static_cast<float>(x) + fu[i]) / static_cast<float>(width_),
                    (static_cast<float>(y) + fv[i]) / static_cast<float>(height_));
    rays[i] = generate_ray(camera_, film, camera_.lens_radius > 0 ? Vec2(lu[i], lv[i]) : Vec2(0.5f));
  }
}

void CameraRays::describe(const Ray& ray, const RayHit& hit, const SurfaceHit& surface, PixelSample& sample) const {
  sample.depth = -dot(ray.direction, camera_.to_world.z) * hit.t;
  sample.normal = dot(surface.shading_normal, ray.direction) > 0 ? -surface.shading_normal : surface.shading_normal;
}

/// A path under way: the ray that leaves its last vertex, and what it is worth.
struct PathIntegrator::Path {
  Ray ray;
  Spectrum throughput{1};
  float pdf_bsdf = 0;     ///< of the ray's direction; 0: only this ray finds what it meets (camera, delta lobe)
  float eta_scale = 1;    ///< product of eta² along the path: what refraction did to the throughput is no reason to end it
};

/// Where a path is scattered.
struct PathIntegrator::Vertex {
  SurfaceHit surface;
  Frame frame;
  Vec3 wo;        ///< world
  Vec3 wo_local;
  Bsdf bsdf = BlackBsdf{};
};

/// The paths of one call to estimate().
class PathIntegrator::Batch {
 public:
  Batch(const PathIntegrator& integrator, int x, int y, std::uint32_t first, std::span<PixelSample> samples)
      : self_(integrator),
        scene_(integrator.scene_),
        sampler_(integrator.settings_.sampler, integrator.settings_.seed, static_cast<std::uint32_t>(x),
                 static_cast<std::uint32_t>(y)),
        first_(first),
        samples_(samples),
        count_(static_cast<int>(samples.size())) {
    start(x, y);
  }

  std::uint64_t run() {
    for (int bounce = 0; active_count_ > 0; ++bounce) {
      if (bounce > 0) intersect();
      arrive(bounce);
      if (bounce >= self_.settings_.max_depth) break;
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
  void arrive(int bounce);
  void sample_lights(int bounce);
  void sample_one_light(int bounce);
  void sample_light_for_all(int bounce, std::uint32_t light);
  void sample_hemisphere(int bounce);
  void scatter(int bounce);

  void see_infinity(int i);
  void see_emission(int i, const SurfaceHit& surface, const Vec3& wo, const Spectrum& emission, std::uint32_t light);
  void aim(int i, std::uint32_t light, const LightPlan& plan, Vec2 u);
  void flush_shadow_rays();
  Spectrum emission_along(const Ray& ray);
  bool counts_emission(const Path& path) const { return !self_.hemisphere_ || path.pdf_bsdf == 0; }

  const PathIntegrator& self_;
  const RenderScene::Data& scene_;
  PixelSampler sampler_;
  std::uint32_t first_;
  std::span<PixelSample> samples_;
  int count_;
  std::uint64_t rays_ = 0;

  Path paths_[kBatch];
  Vertex vertices_[kBatch];
  RayHit hits_[kBatch];
  int active_[kBatch];
  int active_count_ = 0;

  Ray shadow_rays_[kBatch];
  Spectrum shadow_radiance_[kBatch];
  int shadow_path_[kBatch];
  int shadow_count_ = 0;
};

void PathIntegrator::Batch::start(int x, int y) {
  Ray rays[kBatch];
  self_.camera_rays_.generate(sampler_, x, y, first_, std::span(rays, count_));
  scene_.geometry.intersect_coherent(std::span<const Ray>(rays, count_), std::span(hits_, count_));
  rays_ += count_;
  for (int i = 0; i < count_; ++i) {
    samples_[i] = {};
    paths_[i].ray = rays[i];
    active_[active_count_++] = i;
  }
}

void PathIntegrator::Batch::intersect() {
  for (int a = 0; a < active_count_; ++a) hits_[active_[a]] = scene_.geometry.intersect(paths_[active_[a]].ray);
  rays_ += active_count_;
}

void PathIntegrator::Batch::see_infinity(int i) {
  const Path& path = paths_[i];
  if (!counts_emission(path)) return;
  for (const std::uint32_t index : scene_.infinite_lights) {
    const InfiniteView view = look_at_infinity(scene_.lights[index], path.ray.direction);
    const float weight = path.pdf_bsdf > 0 ? mis_weight(path.pdf_bsdf, view.pdf * self_.plan(index).density()) : 1.0f;
    samples_[i].radiance += path.throughput * view.radiance * weight;
  }
}

void PathIntegrator::Batch::see_emission(int i, const SurfaceHit& surface, const Vec3& wo, const Spectrum& emission,
                                         std::uint32_t light) {
  const Path& path = paths_[i];
  if (dot(wo, surface.geometric_normal) <= 0 || !counts_emission(path)) return;
  float weight = 1;
  if (path.pdf_bsdf > 0) {
    const LightHit hit{surface.position, surface.geometric_normal, hits_[i].primitive};
    weight = mis_weight(path.pdf_bsdf, light_pdf(scene_.lights[light], path.ray.origin, hit) * self_.plan(light).density());
  }
  samples_[i].radiance += path.throughput * emission * weight;
}

void PathIntegrator::Batch::arrive(int bounce) {
  int kept = 0;
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (!hits_[i].found()) {
      see_infinity(i);
      continue;
    }
    Vertex& vertex = vertices_[i];
    vertex.surface = scene_.geometry.surface(paths_[i].ray, hits_[i]);
    vertex.wo = -paths_[i].ray.direction;
    const RenderScene::Data::ShapeInfo& shape = scene_.shapes[hits_[i].shape];
    const Material& material = scene_.materials[shape.material];
    if (shape.light != kNone) see_emission(i, vertex.surface, vertex.wo, material.emission, shape.light);
    const Vec2 uv = material.needs_texture_coordinates()
                        ? scene_.geometry.texture_coordinates(hits_[i], vertex.surface)
                        : Vec2(0);
    vertex.bsdf = evaluate_material(material, uv, scene_.textures);
    if (bounce == 0) {
      self_.camera_rays_.describe(paths_[i].ray, hits_[i], vertex.surface, samples_[i]);
      samples_[i].albedo = albedo(vertex.bsdf);
    }
    // Where the interpolated normal turns away from a viewer who sees the front, only the true one makes sense.
    const Vec3& ng = vertex.surface.geometric_normal;
    const bool consistent = dot(vertex.surface.shading_normal, vertex.wo) * dot(ng, vertex.wo) > 0;
    vertex.frame = Frame::from_normal(consistent ? vertex.surface.shading_normal : ng);
    vertex.wo_local = vertex.frame.to_local(vertex.wo);
    active_[kept++] = i;
  }
  active_count_ = kept;
}

/// Prepares the shadow ray of path i to a point of `light`; it is traced when a packet is full.
void PathIntegrator::Batch::aim(int i, std::uint32_t light, const LightPlan& plan, Vec2 u) {
  const Vertex& vertex = vertices_[i];
  const SurfaceHit& surface = vertex.surface;
  const Point3 from = offset_origin(surface, vertex.wo);
  const std::optional<LightSample> sample = sample_light(scene_.lights[light], from, u);
  if (!sample) return;
  // Light on the far side of the true surface reaches an opaque one only through an interpolated normal.
  if (dot(sample->wi, surface.geometric_normal) * dot(vertex.wo, surface.geometric_normal) <= 0) return;
  const BsdfEval eval = eval_bsdf(vertex.bsdf, vertex.wo_local, vertex.frame.to_local(sample->wi));
  if (eval.f_cos.is_black()) return;
  const float pdf = sample->pdf * plan.density();
  const float weight = sample->is_delta ? 1.0f : mis_weight(pdf, eval.pdf);
  shadow_radiance_[shadow_count_] = paths_[i].throughput * eval.f_cos * sample->radiance * (weight / pdf);
  shadow_rays_[shadow_count_] = shadow_ray(from, *sample);
  shadow_path_[shadow_count_] = i;
  if (++shadow_count_ == kBatch) flush_shadow_rays();
}

void PathIntegrator::Batch::flush_shadow_rays() {
  if (shadow_count_ == 0) return;
  const std::uint32_t blocked = scene_.geometry.occluded(std::span<const Ray>(shadow_rays_, shadow_count_));
  for (int s = 0; s < shadow_count_; ++s)
    if ((blocked >> s & 1u) == 0) samples_[shadow_path_[s]].radiance += shadow_radiance_[s];
  rays_ += shadow_count_;
  shadow_count_ = 0;
}

void PathIntegrator::Batch::sample_lights(int bounce) {
  if (scene_.lights.empty()) return;
  if (self_.every_light_)
    for (std::uint32_t light = 0; light < scene_.lights.size(); ++light) sample_light_for_all(bounce, light);
  else
    sample_one_light(bounce);
  flush_shadow_rays();
}

void PathIntegrator::Batch::sample_light_for_all(int bounce, std::uint32_t light) {
  const LightPlan plan = self_.plan(light);
  float u[kBatch], v[kBatch];
  const auto dim = dimension::at(bounce, dimension::kLights + light);
  // Sample j of path i is number (first + i) · samples + j of one sequence: well spread over the light across all of them.
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (is_delta(vertices_[i].bsdf)) continue;
    for (int done = 0; done < plan.samples; done += kBatch) {
      const int n = std::min(kBatch, plan.samples - done);
      const auto index = (first_ + static_cast<std::uint32_t>(i)) * static_cast<std::uint32_t>(plan.samples);
      sampler_.points(dim, index + static_cast<std::uint32_t>(done), n, u, v);
      for (int j = 0; j < n; ++j) aim(i, light, plan, {u[j], v[j]});
    }
  }
}

void PathIntegrator::Batch::sample_one_light(int bounce) {
  float choice_u[kBatch], choice_v[kBatch], u[kBatch], v[kBatch];
  const bool choose = scene_.lights.size() > 1;
  if (choose) sampler_.points(dimension::at(bounce, dimension::kLightChoice), first_, count_, choice_u, choice_v);
  sampler_.points(dimension::at(bounce, dimension::kLights), first_, count_, u, v);
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    if (is_delta(vertices_[i].bsdf)) continue;
    const auto light = choose ? static_cast<std::uint32_t>(scene_.light_choice.sample(choice_u[i]).index) : 0u;
    aim(i, light, self_.plan(light), {u[i], v[i]});
  }
}

Spectrum PathIntegrator::Batch::emission_along(const Ray& ray) {
  const RayHit hit = scene_.geometry.intersect(ray);
  ++rays_;
  Spectrum radiance;
  if (!hit.found()) {
    for (const std::uint32_t light : scene_.infinite_lights)
      radiance += look_at_infinity(scene_.lights[light], ray.direction).radiance;
    return radiance;
  }
  const RenderScene::Data::ShapeInfo& shape = scene_.shapes[hit.shape];
  if (shape.light == kNone) return radiance;
  const SurfaceHit surface = scene_.geometry.surface(ray, hit);
  return dot(surface.geometric_normal, ray.direction) < 0 ? scene_.materials[shape.material].emission : radiance;
}

void PathIntegrator::Batch::sample_hemisphere(int bounce) {
  const int n = std::max(1, self_.settings_.light_samples) * static_cast<int>(std::max<std::size_t>(1, scene_.lights.size()));
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    const Vertex& vertex = vertices_[i];
    if (is_delta(vertex.bsdf)) continue;
    for (int j = 0; j < n; ++j) {
      float u, v;
      const auto index = (first_ + static_cast<std::uint32_t>(i)) * static_cast<std::uint32_t>(n) + static_cast<std::uint32_t>(j);
      sampler_.points(dimension::at(bounce, dimension::kLights), index, 1, &u, &v);
      Vec3 local = sample_hemisphere_uniform({u, v});
      const float pdf = hemisphere_uniform_pdf(local) * static_cast<float>(n);
      if (vertex.wo_local.z < 0) local.z = -local.z;
      const BsdfEval eval = eval_bsdf(vertex.bsdf, vertex.wo_local, local);
      if (eval.f_cos.is_black()) continue;
      const Vec3 wi = vertex.frame.to_world(local);
      if (dot(wi, vertex.surface.geometric_normal) * dot(vertex.wo, vertex.surface.geometric_normal) <= 0) continue;
      const Spectrum radiance = emission_along({offset_origin(vertex.surface, wi), wi});
      samples_[i].radiance += paths_[i].throughput * eval.f_cos * radiance * (1 / pdf);
    }
  }
}

/// Every path goes on into a direction that its BSDF chooses, or ends.
void PathIntegrator::Batch::scatter(int bounce) {
  float u[kBatch], v[kBatch], choice[kBatch], roulette[kBatch];
  sampler_.points(dimension::at(bounce, dimension::kDirection), first_, count_, u, v);
  sampler_.points(dimension::at(bounce, dimension::kLobeAndRoulette), first_, count_, choice, roulette);
  int kept = 0;
  for (int a = 0; a < active_count_; ++a) {
    const int i = active_[a];
    const Vertex& vertex = vertices_[i];
    Path& path = paths_[i];
    const std::optional<BsdfSample> sample = sample_bsdf(vertex.bsdf, vertex.wo_local, {u[i], v[i]}, choice[i]);
    if (!sample) continue;
    const Vec3 wi = normalize(vertex.frame.to_world(sample->wi));  // or rounding would grow along chains of refractions
    const Vec3& ng = vertex.surface.geometric_normal;
    const bool transmitted = sample->lobe == Lobe::delta_transmission;
    if ((dot(wi, ng) * dot(vertex.wo, ng) < 0) != transmitted) continue;  // only the interpolated normal allows it
    path.throughput *= sample->weight;
    path.eta_scale *= square(sample->eta);
    if (bounce + 1 >= kRouletteStart) {
      const float survival = std::min(path.throughput.max() * path.eta_scale, kMaxSurvival);
      if (roulette[i] >= survival) continue;
      path.throughput *= 1 / survival;
    }
    if (path.throughput.is_black()) continue;
    path.pdf_bsdf = sample->pdf;
    path.ray = {offset_origin(vertex.surface, wi), wi};
    active_[kept++] = i;
  }
  active_count_ = kept;
}

PathIntegrator::PathIntegrator(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings)
    : scene_(scene),
      settings_(settings),
      camera_rays_(camera, settings),
      every_light_(settings.light_samples > 0),
      hemisphere_(settings.integrator == IntegratorKind::hemisphere) {
  if (settings.integrator == IntegratorKind::direct) settings_.max_depth = std::min(settings.max_depth, 1);
}

PathIntegrator::LightPlan PathIntegrator::plan(std::uint32_t light) const {
  if (!every_light_) return {1, scene_.light_choice.probability(light)};
  return {is_delta(scene_.lights[light]) ? 1 : settings_.light_samples, 1};
}

std::uint64_t PathIntegrator::estimate(int x, int y, std::uint32_t first, std::span<PixelSample> samples) const {
  return Batch(*this, x, y, first, samples).run();
}

std::unique_ptr<Integrator> make_integrator(const RenderScene::Data& scene, const Camera& camera,
                                            const RenderSettings& settings) {
  switch (settings.integrator) {
    case IntegratorKind::path:
    case IntegratorKind::direct:
    case IntegratorKind::hemisphere: return std::make_unique<PathIntegrator>(scene, camera, settings);
    case IntegratorKind::normals:
    case IntegratorKind::albedo:
    case IntegratorKind::ao: break;
  }
  return std::make_unique<DebugIntegrator>(scene, camera, settings);
}

}  // namespace etendue
