#include "render/volume_path_integrator.h"

#include "math/frame.h"
#include "media/airlight.h"
#include "render/dimensions.h"
#include "render/direct_light.h"
#include "render/generations.h"
#include "render/pixel_width.h"
#include "render/vertex.h"
#include "sampling/warp.h"

#include <algorithm>
#include <array>

namespace etendue {
namespace {

/// Paths that were scattered less often are never ended by roulette, nor are those of fewer segments: passing
/// boundaries that do nothing costs a path no light.
constexpr int kRouletteStart = 6;
constexpr int kManySegments = 1000;
constexpr float kMaxSurvival = 0.99f;

/// Paths that were scattered more often look for lamps only where they are scattered: what is left to them is worth
/// fewer rays. Not where light is looked up: what is recorded serves wherever a path gets there.
constexpr int kAirlightBounces = 3;

/// Places on each of the camera's segments where light is looked up.
constexpr int kLookups = 8;
/// Steps to the unit in which directions are told apart where the phase function's g is ½.
constexpr float kDirectionSteps = 4;

/// The medium into which `direction` leads from a surface, for a path that has come there through `medium`.
std::uint32_t medium_beyond(const RenderScene::Data::ShapeInfo& shape, const Vec3& geometric_normal,
                            const Vec3& direction, std::uint32_t medium) {
  if (!shape.separates_media) return medium;
  return dot(direction, geometric_normal) > 0 ? shape.exterior : shape.interior;
}

/// 1 / s; 0 of what is 0.
Spectrum inverse(const Spectrum& s) {
  const auto of = [](float x) { return x > 0 ? 1 / x : 0.0f; };
  return {of(s.r), of(s.g), of(s.b)};
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
  /// With a `record` the path serves it alone, and is not the sample's.
  Walk(const VolumePathIntegrator& integrator, const PixelSampler& sampler, std::uint64_t index, const Ray& ray,
       PixelSample& sample, std::optional<RadianceRecord>* record = nullptr)
      : scene_(integrator.scene_),
        settings_(integrator.settings_),
        camera_rays_(integrator.camera_rays_),
        lamps_(integrator.lamps_),
        bounds_(integrator.bounds_),
        tracks_(integrator.tracks_),
        airlight_bounces_(integrator.airlight_bounces_),
        cell_side_(integrator.cache_filler_ ? integrator.cache_filler_->cell_side() : 0),
        cache_(integrator.cache_ && record == nullptr ? &*integrator.cache_ : nullptr),
        record_(record),
        sampler_(sampler),
        index_(index),
        sample_(sample),
        ray_(ray),
        medium_(integrator.scene_.camera_medium) {}

  std::uint64_t run() {
    while (advance()) ++segment_;
    if (record_ != nullptr && *record_) (*record_)->radiance = sample_.radiance;
    return rays_;
  }

 private:
  bool advance();
  RayHit find_hit();
  /// Light of lamps that is scattered on the way through the medium.
  void gather_airlight(const Ray& way);
  void gather_airlight(const Ray& way, const Lamp& lamp, float probability, float u);
  /// The lamp's light that is scattered somewhere else and comes from there to the place, where a path is scattered.
  template <typename View>
  void add_beam(const Point3& at, const View& view);
  /// p_beam of y at x.
  float beam_pdf(const Point3& x, const Point3& y, const Lamp& lamp) const;
  /// The same with d² = |xy|² and s, where the beam's ray is seen from x.
  static float beam_pdf(const Lamp& lamp, const SeenRay& seen, double offset, float d2, float s);
  /// p_way of y at x, but for the density of the direction.
  static float way_pdf(const Point3& x, const Point3& y, const Lamp& lamp);
  Ray beam(const Lamp& lamp, const Vec3& direction) const { return within_bounds({lamp.position, direction}, bounds_); }
  bool seeks_record() const { return record_ != nullptr && !*record_; }
  /// What the cache may know of light that is scattered in the medium at the position, or by the surface.
  std::optional<RadianceRecord> record_at(const Point3& position) const;
  std::optional<RadianceRecord> record_at(const Vertex& vertex) const;
  /// Whether directions that were chosen with this density are spread widely as seen from that far.
  bool is_spread(const Vec3& way, float pdf) const {
    return length_squared(way) > square(kSpreadInCells * cell_side_) * pdf;
  }
  /// What the cache knows, if the path's samples of this place look there at all.
  const RadianceCache::Light* known(const std::optional<RadianceRecord>& record) const {
    return record && cache_ != nullptr ? cache_->find(*record) : nullptr;
  }
  /// Whether several places on the segment share what is looked up there.
  bool looks_up_along() const {
    return cache_ != nullptr && scatterings_ == 0 && scene_.media[medium_].is_homogeneous();
  }
  void look_up_along(const Ray& way, Vec2 u);
  bool starts_recording(const std::optional<RadianceRecord>& record);
  bool starts_where_scattered() const { return pdf_scatter_ > 0 && ray_.origin == scattered_at_.position; }
  bool scatter_in_medium(float t);
  bool meet_surface(const RayHit& hit);
  bool survives_roulette();

  void see_infinity();
  void see_emission(const Vertex& vertex);
  float weight_of_found(float pdf_light) const {
    return pdf_scatter_ > 0 ? mis_weight(pdf_scatter_ * survival_, pdf_light) : 1.0f;
  }

  /// Adds direct light at a place; view(wi) gives what is scattered of light from there, or nothing, as
  /// std::optional<LitView>. `lamps_done`: the segment that ends here has gathered the lamps' light.
  template <typename View>
  void add_direct_light(const Receiver& at, bool lamps_done, const View& view);
  template <typename View>
  void add_light(const Spectrum& throughput, const LightChooser::Choice& chosen, Vec2 u, const Point3& from,
                 const View& view);
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
    return sampler_.point(dimension::at(segment_, slot), index);
  }
  bool gathers_airlight() const {
    return !lamps_.empty() && depth_ < airlight_bounces_ && !seeks_record() && scene_.media[medium_].is_homogeneous();
  }
  bool may_bounce() const { return depth_ < settings_.max_depth; }
  bool hides_emitters() const { return from_camera_ && settings_.hide_emitters; }
  /// Where passing a surface is a bounce, what lies behind one is not seen directly.
  bool hides_shining_shapes() const { return hides_emitters() && (segment_ == 0 || !settings_.null_counts_as_bounce); }

  const RenderScene::Data& scene_;
  const RenderSettings& settings_;
  const CameraRays& camera_rays_;
  const std::vector<Lamp>& lamps_;
  const Bounds3& bounds_;
  bool tracks_;
  int airlight_bounces_;
  float cell_side_;
  const RadianceCache* cache_;
  std::optional<RadianceRecord>* record_;
  const PixelSampler& sampler_;
  std::uint64_t index_;
  PixelSample& sample_;
  std::uint64_t rays_ = 0;

  Ray ray_;
  std::uint32_t medium_;  ///< through which the ray runs
  RandomStream random_;   ///< of this segment, where some medium is heterogeneous
  Spectrum throughput_{1};
  float pdf_scatter_ = 0;  ///< of the direction chosen last; 0: only this ray finds what it meets (camera, delta lobe)
  float survival_ = 1;     ///< as Transmittance has it, since then
  Receiver scattered_at_;  ///< where that direction was chosen
  float eta_scale_ =
      1;           ///< product of eta² along the path: what refraction did to the throughput is no reason to end it
  int depth_ = 0;  ///< bounces so far
  int segment_ = 0;
  bool from_camera_ = true;  ///< has not been scattered yet
  int scatterings_ = 0;      ///< by anything but delta lobes
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
  if (tracks_) random_ = RandomStream(random_point(dimension::kTracking));
  if (medium_ != kNone) {
    Ray way = ray_;
    if (hit.found()) way.t_max = hit.t;
    if (gathers_airlight() && may_bounce()) gather_airlight(way);
    const Vec2 u = random_point(dimension::kFreeFlight);
    if (looks_up_along() && may_bounce()) look_up_along(way, u);
    const Flight flight = sample_flight(scene_.media[medium_], way, throughput_, u, random_);
    throughput_ *= flight.weight;
    survival_ *= flight.survival;
    if (flight.t) return scatter_in_medium(off_the_end(way, *flight.t));
  }
  if (hit.found()) return meet_surface(hit);
  see_infinity();
  return false;
}

void VolumePathIntegrator::Walk::gather_airlight(const Ray& way) {
  const Vec2 u = random_point(dimension::kAirlight);
  if (lamps_.size() == 1 || settings_.light_samples > 0) {
    for (const Lamp& lamp : lamps_) gather_airlight(way, lamp, 1, u.y);
    return;
  }
  const Spectrum extinction = scene_.media[medium_].extinction(way.origin);
  const float sigma = std::min({extinction.r, extinction.g, extinction.b});
  std::array<float, kMostLamps> promised;
  float total = 0;
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    const Lamp& lamp = lamps_[i];
    const std::optional<Ray> lit = within_cone(way, lamp.position, lamp.axis, lamp.cos_angle);
    promised[i] = lit ? lamp.intensity * std::exp(-sigma * (lit->t_min - way.t_min)) *
                            static_cast<float>(SeenRay(*lit, lamp.position).inverse_squares())
                      : 0.0f;
    total += promised[i];
  }
  float rest = u.x * total;
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    if (rest < promised[i]) return gather_airlight(way, lamps_[i], promised[i] / total, u.y);
    rest -= promised[i];
  }
}

void VolumePathIntegrator::Walk::gather_airlight(const Ray& way, const Lamp& lamp, float probability, float u) {
  const std::optional<Ray> lit = within_cone(way, lamp.position, lamp.axis, lamp.cos_angle);
  if (!lit) return;
  const Medium& medium = scene_.media[medium_];
  const auto dimmed = [&](float from, float to) {
    return transmittance(medium, {way.origin, way.direction, from, to}, throughput_, random_).share;
  };
  const Spectrum arriving = throughput_ * dimmed(way.t_min, lit->t_min);
  const auto distance = AirlightDistances(medium, *lit, SeenRay(*lit, lamp.position), arriving).sample(u);
  if (!distance) return;
  const float t = off_the_end(way, distance->t);
  const Point3 position = way.at(t);
  const Spectrum scattered = arriving * dimmed(lit->t_min, t) * medium.extinction(position) * medium.albedo(position);
  float weight = 1;
  if (starts_where_scattered()) {
    const float pdf_way = pdf_scatter_ * way_pdf(way.origin, position, lamp);
    weight = pdf_way > 0 ? mis_weight(pdf_way, beam_pdf(way.origin, position, lamp)) : 0.0f;
  }
  add_light(scattered * (weight / distance->pdf), {lamp.light, 0, probability}, {}, position,
            [&](const Vec3& wi) -> std::optional<LitView> {
              const float value = eval_phase(medium.phase(), -way.direction, wi);
              return LitView{{Spectrum(value), value}, position, medium_};
            });
}

template <typename View>
void VolumePathIntegrator::Walk::add_beam(const Point3& at, const View& view) {
  if (lamps_.empty() || depth_ + 1 >= std::min(settings_.max_depth, airlight_bounces_)) return;
  const Vec2 choice = random_point(dimension::kBeamPoint);
  float rest = choice.x;
  const Lamp* chosen = lamps_.data();
  for (; rest >= chosen->chance && chosen != &lamps_.back(); ++chosen) rest -= chosen->chance;
  const Lamp& lamp = *chosen;
  const Vec3 local = sample_cone_uniform(random_point(dimension::kBeam), lamp.one_minus_cos);
  const Ray ray = beam(lamp, Frame::from_normal(lamp.axis).to_world(local));
  if (!(ray.t_min < ray.t_max)) return;
  const SeenRay seen(ray, at);
  const double angle = seen.begin + static_cast<double>(choice.y) * (seen.end - seen.begin);
  const double offset = std::clamp(seen.distance * std::tan(angle), seen.begin_offset, seen.end_offset);
  const float s = static_cast<float>(seen.nearest + offset);
  const Point3 position = ray.at(s);
  const float d2 = length_squared(position - at);
  const float pdf = beam_pdf(lamp, seen, offset, d2, s);
  if (!(d2 > 0) || !(s > 0) || !(pdf > 0)) return;
  const Vec3 to_beam = (position - at) * (1 / std::sqrt(d2));
  const std::optional<LitView> lit = view(to_beam);
  if (!lit || lit->eval.f_cos.is_black() || lit->medium == kNone || !scene_.media[lit->medium].is_homogeneous()) return;
  const Medium& medium = scene_.media[lit->medium];
  const float weight = mis_weight(pdf, lit->eval.pdf * way_pdf(at, position, lamp));
  const Spectrum scattered = throughput_ * lit->eval.f_cos * medium.extinction(position) * medium.albedo(position);
  add_light(scattered * (weight / pdf), {lamp.light, 0, 1}, {}, position,
            [&](const Vec3& wi) -> std::optional<LitView> {
              const Vec3 way = position - lit->start;
              const float distance = length(way);
              const Transmittance through =
                  passage({lit->start, way * (1 / distance), 0, distance}, 0, lit->medium, scattered);
              const float value = eval_phase(medium.phase(), -to_beam, wi);
              return LitView{{through.share * value, value}, position, lit->medium};
            });
}

float VolumePathIntegrator::Walk::beam_pdf(const Lamp& lamp, const SeenRay& seen, double offset, float d2, float s) {
  return lamp.chance * cone_uniform_pdf(lamp.one_minus_cos) * static_cast<float>(seen.uniform_angle_pdf(offset)) * d2 /
         square(s);
}

float VolumePathIntegrator::Walk::beam_pdf(const Point3& x, const Point3& y, const Lamp& lamp) const {
  const Vec3 from_lamp = y - lamp.position;
  const float s = length(from_lamp);
  if (!(s > 0)) return 0;
  const SeenRay seen(beam(lamp, from_lamp * (1 / s)), x);
  return beam_pdf(lamp, seen, static_cast<double>(s) - seen.nearest, length_squared(y - x), s);
}

float VolumePathIntegrator::Walk::way_pdf(const Point3& x, const Point3& y, const Lamp& lamp) {
  const float d = length(y - x);
  if (!(d > 0)) return 0;
  const std::optional<Ray> way = within_cone({x, (y - x) * (1 / d)}, lamp.position, lamp.axis, lamp.cos_angle);
  if (!way) return 0;
  const SeenRay seen(*way, lamp.position);
  return static_cast<float>(seen.uniform_angle_pdf(static_cast<double>(d) - seen.nearest));
}

/// The path's own place, of `u`, is one of them, but is left to scatter_in_medium().
void VolumePathIntegrator::Walk::look_up_along(const Ray& way, Vec2 u) {
  constexpr float kShare = 1.0f / kLookups;
  for (int i = 1; i < kLookups; ++i) {
    const float v = u.y + static_cast<float>(i) * kShare;
    const Flight flight = sample_flight(scene_.media[medium_], way, throughput_, {u.x, v < 1 ? v : v - 1}, random_);
    if (!flight.t) continue;
    if (const auto* light = known(record_at(way.at(off_the_end(way, *flight.t)))))
      sample_.radiance += throughput_ * flight.weight * light->radiance * kShare;
  }
}

std::optional<RadianceRecord> VolumePathIntegrator::Walk::record_at(const Point3& position) const {
  if (cell_side_ == 0) return std::nullopt;
  if (scatterings_ > 0 && !(pdf_scatter_ > 0 && is_spread(position - scattered_at_.position, pdf_scatter_)))
    return std::nullopt;
  const Medium& medium = scene_.media[medium_];
  const auto* phase = std::get_if<HenyeyGreensteinPhase>(&medium.phase());
  const int depth = settings_.max_depth;
  // The sharper the phase function, the more the direction matters.
  return RadianceRecord{.position = position,
                        .normal = -ray_.direction,
                        .turns = phase != nullptr ? kDirectionSteps * std::abs(phase->g) / (1 - std::abs(phase->g)) : 0,
                        .bounces_left = depth == kUnlimitedDepth ? depth : depth - depth_,
                        .medium = medium_};
}

std::optional<RadianceRecord> VolumePathIntegrator::Walk::record_at(const Vertex& vertex) const {
  if (cell_side_ == 0 || scatterings_ == 0 || !(pdf_scatter_ > 0) || !may_bounce()) return std::nullopt;
  if (!vertex.scattering.is_lambertian() || vertex.scattering.albedo().is_black()) return std::nullopt;
  const float cosine = std::abs(dot(vertex.wo, vertex.surface.geometric_normal));
  if (!is_spread(vertex.surface.position - scattered_at_.position, pdf_scatter_ * cosine)) return std::nullopt;
  const Vec3& normal = vertex.scattering.normal();
  const int depth = settings_.max_depth;
  return RadianceRecord{.position = vertex.surface.position,
                        .normal = dot(normal, vertex.wo) < 0 ? -normal : normal,
                        .turns = kNormalSteps,
                        .bounces_left = depth == kUnlimitedDepth ? depth : depth - depth_};
}

/// Whether the path, on its way to something to be recorded, has come there: what it finds from now on is.
bool VolumePathIntegrator::Walk::starts_recording(const std::optional<RadianceRecord>& record) {
  if (record_ == nullptr || *record_ || !record) return false;
  *record_ = record;
  sample_.radiance = Spectrum(0);
  return true;
}

bool VolumePathIntegrator::Walk::scatter_in_medium(float t) {
  if (!may_bounce()) return false;
  const Point3 position = ray_.at(t);
  const Vec3 wo = -ray_.direction;
  const Phase& phase = scene_.media[medium_].phase();
  const auto view = [&](const Vec3& wi) -> std::optional<LitView> {
    const float value = eval_phase(phase, wo, wi);
    return LitView{{Spectrum(value), value}, position, medium_};
  };
  const std::optional<RadianceRecord> record = record_at(position);
  if (!seeks_record()) add_direct_light({position}, gathers_airlight(), view);
  if (const auto* light = known(record)) {
    sample_.radiance += throughput_ * light->radiance * (looks_up_along() ? 1.0f / kLookups : 1.0f);
    return false;
  }
  if (starts_recording(record)) throughput_ = Spectrum(1);
  if (!seeks_record()) add_beam(position, view);
  const PhaseSample next = sample_phase(phase, wo, random_point(dimension::kDirection));
  pdf_scatter_ = next.pdf;
  survival_ = 1;
  scattered_at_ = {position};
  from_camera_ = false;
  ++scatterings_;
  ++depth_;
  ray_ = {position, next.wi};
  return survives_roulette();
}

bool VolumePathIntegrator::Walk::meet_surface(const RayHit& hit) {
  const RenderScene::Data::ShapeInfo& shape = scene_.shapes[hit.shape];
  const Vertex vertex(scene_, ray_, hit);
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
  const bool looks_for_lights = may_bounce() && !scattering.is_delta();
  const Point3 from = offset_origin(vertex.surface, vertex.wo);
  const auto view = [&](const Vec3& wi) -> std::optional<LitView> {
    const bool same_side = dot(wi, ng) * dot(vertex.wo, ng) > 0;
    if (!same_side && !scattering.transmits()) return std::nullopt;
    return LitView{scattering.eval(wi), same_side ? from : offset_origin(vertex.surface, wi),
                   medium_beyond(shape, ng, wi, medium_)};
  };
  if (looks_for_lights && !seeks_record()) add_direct_light(receiver(vertex).moved_to(from), false, view);
  const std::optional<RadianceRecord> record = record_at(vertex);
  if (const auto* light = known(record)) {
    sample_.radiance += throughput_ * scattering.albedo() * light->radiance;
    return false;
  }
  const bool starts = starts_recording(record);
  if (starts) throughput_ = inverse(scattering.albedo());
  if (looks_for_lights && !seeks_record()) add_beam(from, view);
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
    scattered_at_ = receiver(vertex).moved_to(start);
    from_camera_ = false;
    if (!sample->is_delta()) ++scatterings_;
    ++depth_;
  }
  throughput_ = starts ? Spectrum(1) : throughput_ * sample->weight;
  eta_scale_ *= square(sample->eta);
  medium_ = medium_beyond(shape, ng, sample->wi, medium_);
  ray_ = {start, sample->wi};
  return survives_roulette();
}

bool VolumePathIntegrator::Walk::survives_roulette() {
  if (throughput_.is_black()) return false;
  if (depth_ < kRouletteStart && segment_ < kManySegments) return true;
  const float probability = std::min(throughput_.max() * eta_scale_, kMaxSurvival);
  throughput_ *= 1 / probability;
  return random_point(dimension::kLobeAndRoulette).y < probability;
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
void VolumePathIntegrator::Walk::add_direct_light(const Receiver& at, bool lamps_done, const View& view) {
  const auto is_done = [&](std::uint32_t light) {
    return lamps_done && std::ranges::find(lamps_, light, &Lamp::light) != lamps_.end();
  };
  if (scene_.lights.size() == (lamps_done ? lamps_.size() : 0)) return;
  if (settings_.light_samples == 0) {
    const std::optional<LightChooser::Choice> chosen =
        scene_.light_choice.sample(at, fine_uniform(random_point(dimension::kLightChoice)));
    if (chosen && !is_done(chosen->light))
      add_light(throughput_, *chosen, random_point(dimension::position(0)), at.position, view);
    return;
  }
  for (std::uint32_t light = 0; light < scene_.lights.size(); ++light) {
    if (is_done(light)) continue;
    const auto samples = static_cast<std::uint64_t>(samples_of_light(scene_, settings_.light_samples, light));
    for (std::uint64_t i = index_ * samples; i < (index_ + 1) * samples; ++i) {
      const PartChoice chosen = choose_part(scene_.lights[light], random_point(dimension::part(light), i).x);
      add_light(throughput_, {light, chosen.part, static_cast<float>(samples) * chosen.probability},
                random_point(dimension::position(light), i), at.position, view);
    }
  }
}

template <typename View>
void VolumePathIntegrator::Walk::add_light(const Spectrum& throughput, const LightChooser::Choice& chosen, Vec2 u,
                                           const Point3& from, const View& view) {
  const std::optional<LightSample> sample = sample_light(scene_.lights[chosen.light], chosen.part, from, u);
  if (!sample) return;
  const std::optional<LitView> lit = view(sample->wi);
  if (!lit || lit->eval.f_cos.is_black()) return;
  const float pdf = sample->pdf * chosen.probability;
  const Spectrum scattered = throughput * lit->eval.f_cos;
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
    : scene_(scene),
      settings_(settings),
      camera_rays_(scene, camera, settings),
      bounds_(scene.geometry.bounds()),
      tracks_(!std::ranges::all_of(scene.media, &Medium::is_homogeneous)) {
  if (settings.integrator == IntegratorKind::direct) settings_.max_depth = std::min(settings.max_depth, 1);
  const bool is_plain = settings.integrator == IntegratorKind::path && settings.airlight == Use::automatic;
  if (settings.airlight != Use::off && !is_plain) lamps_ = find_lamps(scene);
  if (looks_up(settings) && !scene.measured) {
    cache_filler_.emplace(settings, usual_pixel_width(scene, camera, settings));
    if (cache_filler_->cell_side() == 0) cache_filler_.reset();
  }
  airlight_bounces_ = cache_filler_ ? kUnlimitedDepth : kAirlightBounces;
}

std::string_view VolumePathIntegrator::promise() const {
  if (cache_filler_) return "consistent: cells blur light that was scattered twice, the less the more samples";
  return Integrator::promise();
}

std::uint32_t VolumePathIntegrator::generation_size() const {
  return cache_filler_ ? usual_generation_size(settings_) : Integrator::generation_size();
}

std::uint64_t VolumePathIntegrator::prepare(std::uint32_t generation) {
  if (!cache_filler_) return 0;
  cache_.reset();
  return cache_filler_->fill(generation, scene_.geometry, cache_,
                             [&](int x, int y, std::uint32_t first, std::span<std::optional<RadianceRecord>> records) {
                               const PixelSampler sampler(settings_.sampler, settings_.seed + kRecordSeed,
                                                          static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
                               Ray rays[Geometry::kBatch];
                               PixelSample samples[Geometry::kBatch];
                               camera_rays_.generate(sampler, x, y, first, std::span(rays, records.size()), samples);
                               std::uint64_t traced = 0;
                               for (std::size_t i = 0; i < records.size(); ++i)
                                 traced += Walk(*this, sampler, first + i, rays[i], samples[i], &records[i]).run();
                               return traced;
                             });
}

std::vector<VolumePathIntegrator::Lamp> VolumePathIntegrator::find_lamps(const RenderScene::Data& scene) {
  constexpr float kNarrowest = 1e-7f;  // cone
  std::vector<Lamp> lamps;
  for (std::uint32_t light = 0; light < scene.lights.size(); ++light) {
    const std::optional<LightBounds> bounds = light_bounds(scene.lights[light], 0);
    if (!bounds || !is_delta(scene.lights[light])) continue;
    const float angle = bounds->normals.angle;
    lamps.push_back({light, bounds->box.min, bounds->normals.axis, std::cos(angle),
                     std::max(2 * square(std::sin(0.5f * angle)), kNarrowest), bounds->intensity});
  }
  if (lamps.size() > kMostLamps) lamps.clear();
  float power = 0;
  for (const Lamp& lamp : lamps) power += lamp.intensity * lamp.one_minus_cos;
  for (Lamp& lamp : lamps)
    lamp.chance = power > 0 ? lamp.intensity * lamp.one_minus_cos / power : 1 / static_cast<float>(lamps.size());
  return lamps;
}

std::uint64_t VolumePathIntegrator::estimate(const PixelBlock& block, std::uint32_t first, int count,
                                             std::span<PixelSample> samples) const {
  const PixelSampler sampler(settings_.sampler, settings_.seed, static_cast<std::uint32_t>(block.x),
                             static_cast<std::uint32_t>(block.y),
                             static_cast<std::uint32_t>(settings_.samples_per_pixel));
  Ray rays[Geometry::kBatch];
  camera_rays_.generate(sampler, block.x, block.y, first, std::span(rays, samples.size()), samples);
  std::uint64_t traced = 0;
  for (int i = 0; i < count; ++i)
    traced += Walk(*this, sampler, first + static_cast<std::uint32_t>(i), rays[i], samples[i]).run();
  return traced;
}

}  // namespace etendue
