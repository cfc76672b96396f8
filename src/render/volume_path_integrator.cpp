#include "render/volume_path_integrator.h"

#include "render/dimensions.h"
#include "render/direct_light.h"
#include "render/vertex.h"

namespace etendue {
namespace {

/// Paths that were scattered less often are never ended by roulette, nor are those of fewer segments: passing
/// boundaries that do nothing costs a path no light.
constexpr int kRouletteStart = 6;
constexpr int kManySegments = 1000;
constexpr float kMaxSurvival = 0.99f;

/// The medium into which `direction` leads from a surface, for a path that has come there through `medium`.
std::uint32_t medium_beyond(const RenderScene::Data::ShapeInfo& shape, const Vec3& geometric_normal,
                            const Vec3& direction, std::uint32_t medium) {
  if (!shape.separates_media) return medium;
  return dot(direction, geometric_normal) > 0 ? shape.exterior : shape.interior;
}

/// A point at distance t, kept off the end of the ray, which lies on a surface, by more than rounding.
float off_the_end(const Ray& ray, float t) {
  if (std::isinf(ray.t_max)) return t;
  const float margin = kRelativeError * (max_abs_component(ray.origin) + ray.t_max);
  return std::min(t, std::max(ray.t_max - margin, 0.5f * (ray.t_min + ray.t_max)));
}

/// A light's direction seen from where light is scattered: what is scattered, and where a shadow ray begins.
struct LitView {
  BsdfEval eval;
  Point3 start;
  std::uint32_t medium;
};

}  // namespace

/// One path.
class VolumePathIntegrator::Walk {
 public:
  Walk(const RenderScene::Data& scene, const RenderSettings& settings, const CameraRays& camera_rays,
       const PixelSampler& sampler, std::uint64_t index, const Ray& ray, PixelSample& sample)
      : scene_(scene),
        settings_(settings),
        camera_rays_(camera_rays),
        sampler_(sampler),
        index_(index),
        sample_(sample),
        ray_(ray),
        medium_(scene.camera_medium) {}

  std::uint64_t run() {
    while (advance()) ++segment_;
    return rays_;
  }

 private:
  bool advance();
  RayHit find_hit();
  bool scatter_in_medium(float t);
  bool meet_surface(const RayHit& hit);
  bool survives_roulette(float u);

  void see_infinity();
  void see_emission(const Vertex& vertex);
  float weight_of_found(float pdf_light) const {
    return pdf_scatter_ > 0 ? mis_weight(pdf_scatter_ * survival_, pdf_light) : 1.0f;
  }

  /// Adds direct light at a place; view(wi) gives what is scattered of light from there, or nothing, as
  /// std::optional<LitView>.
  template <typename View>
  void add_direct_light(const Receiver& at, const View& view);
  template <typename View>
  void add_light(const LightChooser::Choice& chosen, Vec2 u, const Point3& from, const View& view);
  Transmittance passage(Ray ray, int most_surfaces, std::uint32_t medium, const Spectrum& throughput);
  /// How many surfaces a shadow ray may pass straight through. Where passing is a bounce, light of no size is not found
  /// by it, as in Mitsuba's path tracer.
  int most_surfaces_passed(bool is_delta) const {
    if (!settings_.null_counts_as_bounce) return kUnlimitedDepth;
    return is_delta ? 0 : settings_.max_depth - depth_ - 1;
  }

  float density_where_scattered(std::uint32_t light, std::uint32_t part) const {
    return pdf_scatter_ > 0 ? light_density(scene_, settings_.light_samples, scattered_at_, light, part) : 0.0f;
  }
  RayHit intersect(const Ray& ray) {
    ++rays_;
    return scene_.geometry.intersect(ray);
  }
  Vec2 random_point(std::uint64_t slot) const { return random_point(slot, index_); }
  Vec2 random_point(std::uint64_t slot, std::uint64_t index) const {
    Vec2 u;
    sampler_.points(dimension::at(segment_, slot), index, 1, &u.x, &u.y);
    return u;
  }
  bool may_bounce() const { return depth_ < settings_.max_depth; }
  bool hides_emitters() const { return from_camera_ && settings_.hide_emitters; }
  /// Where passing a surface is a bounce, what lies behind one is not seen directly.
  bool hides_shining_shapes() const { return hides_emitters() && (segment_ == 0 || !settings_.null_counts_as_bounce); }

  const RenderScene::Data& scene_;
  const RenderSettings& settings_;
  const CameraRays& camera_rays_;
  const PixelSampler& sampler_;
  std::uint64_t index_;
  PixelSample& sample_;
  std::uint64_t rays_ = 0;

  Ray ray_;
  std::uint32_t medium_;  ///< through which the ray runs
  RandomStream random_;   ///< of this segment
  Spectrum throughput_{1};
  float pdf_scatter_ = 0;  ///< of the direction chosen last; 0: only this ray finds what it meets (camera, delta lobe)
  float survival_ = 1;     ///< as Transmittance has it, since then
  Receiver scattered_at_;  ///< where that direction was chosen
  float eta_scale_ =
      1;           ///< product of eta² along the path: what refraction did to the throughput is no reason to end it
  int depth_ = 0;  ///< bounces so far
  int segment_ = 0;
  bool from_camera_ = true;  ///< has not been scattered yet
};

/// What the ray meets. The camera sees neither the lights that it is not to see nor, where no medium surrounds it,
/// their shapes.
RayHit VolumePathIntegrator::Walk::find_hit() {
  const RayHit hit = intersect(ray_);
  if (!hides_shining_shapes() || medium_ != kNone) return hit;
  const Meeting behind = behind_lights(scene_, ray_, hit);
  ray_ = behind.ray;
  rays_ += static_cast<std::uint64_t>(behind.rays);
  return behind.hit;
}

/// Follows the ray to where the path goes on. False: it does not.
bool VolumePathIntegrator::Walk::advance() {
  const RayHit hit = find_hit();
  random_ = RandomStream(random_point(dimension::kTracking));
  if (medium_ != kNone) {
    Ray way = ray_;
    if (hit.found()) way.t_max = hit.t;
    const Flight flight =
        sample_flight(scene_.media[medium_], way, throughput_, random_point(dimension::kFreeFlight), random_);
    throughput_ *= flight.weight;
    survival_ *= flight.survival;
    if (flight.t) return scatter_in_medium(off_the_end(way, *flight.t));
  }
  if (hit.found()) return meet_surface(hit);
  see_infinity();
  return false;
}

bool VolumePathIntegrator::Walk::scatter_in_medium(float t) {
  if (!may_bounce()) return false;
  const Point3 position = ray_.at(t);
  const Vec3 wo = -ray_.direction;
  const Phase& phase = scene_.media[medium_].phase();
  add_direct_light({position}, [&](const Vec3& wi) -> std::optional<LitView> {
    const float value = eval_phase(phase, wo, wi);
    return LitView{{Spectrum(value), value}, position, medium_};
  });
  const PhaseSample next = sample_phase(phase, wo, random_point(dimension::kDirection));
  pdf_scatter_ = next.pdf;
  survival_ = 1;
  scattered_at_ = {position};
  from_camera_ = false;
  ++depth_;
  ray_ = {position, next.wi};
  return survives_roulette(random_point(dimension::kLobeAndRoulette).y);
}

bool VolumePathIntegrator::Walk::meet_surface(const RayHit& hit) {
  const RenderScene::Data::ShapeInfo& shape = scene_.shapes[hit.shape];
  const Vertex vertex = find_vertex(scene_, ray_, hit);
  const Scattering& scattering = vertex.scattering;
  const Vec3& ng = vertex.surface.geometric_normal;
  if (vertex.light != kNone) see_emission(vertex);
  if (segment_ == 0) {
    camera_rays_.describe(ray_, vertex.surface, sample_);
    sample_.albedo = scattering.albedo();
  }
  const Spectrum straight = scattering.straight_through();
  const bool may_pass_freely = !straight.is_black() && !settings_.null_counts_as_bounce;
  if (!may_bounce() && !may_pass_freely) return false;
  if (may_bounce() && !scattering.is_delta()) {
    const Point3 from = offset_origin(vertex.surface, vertex.wo);
    add_direct_light({from, receiver(vertex).normal}, [&](const Vec3& wi) -> std::optional<LitView> {
      const bool same_side = dot(wi, ng) * dot(vertex.wo, ng) > 0;
      if (!same_side && !scattering.transmits()) return std::nullopt;
      return LitView{scattering.eval(wi), same_side ? from : offset_origin(vertex.surface, wi),
                     medium_beyond(shape, ng, wi, medium_)};
    });
  }
  const Vec2 choice = random_point(dimension::kLobeAndRoulette);
  const std::optional<BsdfSample> sample = scattering.sample(random_point(dimension::kDirection), choice.x);
  if (!sample) return false;
  const Point3 start = offset_origin(vertex.surface, sample->wi);
  if (sample->lobe == Lobe::straight) {
    survival_ *= straight.max();
    depth_ += settings_.null_counts_as_bounce ? 1 : 0;
  } else {
    if (!may_bounce()) return false;
    pdf_scatter_ = sample->pdf;
    survival_ = 1;
    scattered_at_ = {start, receiver(vertex).normal};
    from_camera_ = false;
    ++depth_;
  }
  throughput_ *= sample->weight;
  eta_scale_ *= square(sample->eta);
  medium_ = medium_beyond(shape, ng, sample->wi, medium_);
  ray_ = {start, sample->wi};
  return survives_roulette(choice.y);
}

bool VolumePathIntegrator::Walk::survives_roulette(float u) {
  if (throughput_.is_black()) return false;
  if (depth_ < kRouletteStart && segment_ < kManySegments) return true;
  const float probability = std::min(throughput_.max() * eta_scale_, kMaxSurvival);
  throughput_ *= 1 / probability;
  return u < probability;
}

void VolumePathIntegrator::Walk::see_infinity() {
  if (hides_emitters()) return;
  for (const std::uint32_t light : scene_.infinite_lights) {
    const InfiniteView view = look_at_infinity(scene_.lights[light], ray_.direction);
    sample_.radiance += throughput_ * view.radiance * weight_of_found(view.pdf * density_where_scattered(light, 0));
  }
}

void VolumePathIntegrator::Walk::see_emission(const Vertex& vertex) {
  if (hides_shining_shapes()) return;
  const Light& light = scene_.lights[vertex.light];
  const float pdf = pdf_scatter_ > 0 ? light_pdf(light, scattered_at_.position, vertex.light_hit) : 0.0f;
  const float density = density_where_scattered(vertex.light, part_at(light, vertex.light_hit));
  sample_.radiance += throughput_ * vertex.emission * weight_of_found(pdf * density);
}

template <typename View>
void VolumePathIntegrator::Walk::add_direct_light(const Receiver& at, const View& view) {
  if (scene_.lights.empty()) return;
  if (settings_.light_samples == 0) {
    const std::optional<LightChooser::Choice> chosen =
        scene_.light_choice.sample(at, fine_uniform(random_point(dimension::kLightChoice)));
    if (chosen) add_light(*chosen, random_point(dimension::position(0)), at.position, view);
    return;
  }
  for (std::uint32_t light = 0; light < scene_.lights.size(); ++light) {
    const auto samples = static_cast<std::uint64_t>(samples_of_light(scene_, settings_.light_samples, light));
    for (std::uint64_t i = index_ * samples; i < (index_ + 1) * samples; ++i) {
      const PartChoice chosen = choose_part(scene_.lights[light], random_point(dimension::part(light), i).x);
      add_light({light, chosen.part, static_cast<float>(samples) * chosen.probability},
                random_point(dimension::position(light), i), at.position, view);
    }
  }
}

template <typename View>
void VolumePathIntegrator::Walk::add_light(const LightChooser::Choice& chosen, Vec2 u, const Point3& from,
                                           const View& view) {
  const std::optional<LightSample> sample = sample_light(scene_.lights[chosen.light], chosen.part, from, u);
  if (!sample) return;
  const std::optional<LitView> lit = view(sample->wi);
  if (!lit || lit->eval.f_cos.is_black()) return;
  const float pdf = sample->pdf * chosen.probability;
  const Spectrum scattered = throughput_ * lit->eval.f_cos;
  const Transmittance through =
      passage(shadow_ray(lit->start, from, *sample), most_surfaces_passed(sample->is_delta), lit->medium, scattered);
  if (through.share.is_black()) return;
  const float weight = sample->is_delta ? 1.0f : mis_weight(pdf, lit->eval.pdf * through.survival);
  sample_.radiance += scattered * through.share * sample->radiance * (weight / pdf);
}

/// What gets along a shadow ray through media, and straight through at most so many surfaces.
Transmittance VolumePathIntegrator::Walk::passage(Ray ray, int most_surfaces, std::uint32_t medium,
                                                  const Spectrum& throughput) {
  const Transmittance none{Spectrum(0), 0};
  Transmittance passed;
  while (true) {
    const RayHit hit = intersect(ray);
    if (hit.found() && most_surfaces-- == 0) return none;
    const Spectrum open = hit.found() ? pass_through(scene_, ray, hit) : Spectrum(1);
    if (open.is_black()) return none;
    if (medium != kNone) {
      Ray way = ray;
      if (hit.found()) way.t_max = hit.t;
      const Transmittance t = transmittance(scene_.media[medium], way, throughput * passed.share, random_);
      passed.share *= t.share;
      passed.survival *= t.survival;
      if (passed.share.is_black()) return none;
    }
    if (!hit.found()) return passed;
    passed.share *= open;
    passed.survival *= open.max();
    medium = medium_beyond(scene_.shapes[hit.shape], scene_.geometry.surface(ray, hit).geometric_normal, ray.direction,
                           medium);
    ray = straight_on(scene_, ray, hit);
  }
}

VolumePathIntegrator::VolumePathIntegrator(const RenderScene::Data& scene, const Camera& camera,
                                           const RenderSettings& settings)
    : scene_(scene), settings_(settings), camera_rays_(scene, camera, settings) {
  if (settings.integrator == IntegratorKind::direct) settings_.max_depth = std::min(settings.max_depth, 1);
}

std::uint64_t VolumePathIntegrator::estimate(int x, int y, std::uint32_t first, std::span<PixelSample> samples) const {
  const PixelSampler sampler(settings_.sampler, settings_.seed, static_cast<std::uint32_t>(x),
                             static_cast<std::uint32_t>(y));
  Ray rays[Geometry::kBatch];
  camera_rays_.generate(sampler, x, y, first, std::span(rays, samples.size()), samples);
  std::uint64_t traced = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    traced += Walk(scene_, settings_, camera_rays_, sampler, first + i, rays[i], samples[i]).run();
  }
  return traced;
}

}  // namespace etendue
