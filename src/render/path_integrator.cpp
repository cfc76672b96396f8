#include "render/path_integrator.h"

#include <algorithm>
#include <cmath>

#include "render/debug_integrators.h"
#include "render/generations.h"
#include "render/pixel_width.h"
#include "render/volume_path_integrator.h"

namespace etendue {
namespace {

constexpr int kBatch = Geometry::kBatch;

/// Pixels along the side of a block whose paths are shared: its square is the most that share_paths takes.
constexpr int kReuseSide = 4;
static_assert(kReuseSide * kReuseSide <= std::min(kBatch, PixelBlock::kMost));

/// Pixels that share have as many samples; and those who denoise or doubt expect them to know nothing of each other.
bool shares_paths(const RenderSettings& settings) {
  const bool compares = settings.for_denoising || settings.doubts_outliers;
  if (settings.adaptive || (compares && settings.reuse != Use::on)) return false;
  return uses(settings, settings.reuse);
}

/// Lamps are small and lit surfaces show their images: more directions find them. A sky is found by few.
int useful_looks(const RenderScene::Data& scene) {
  return has_lamps(scene) ? PathCommons::kMostLooks : PathCommons::kMostLooks / 2;
}

/// Two lights, such as a lamp and the sky, are better both asked than one of them by chance. Of more, the light tree
/// knows which matter where.
bool asks_both(const std::vector<Light>& lights) {
  return lights.size() == 2 && std::ranges::all_of(lights, [](const Light& l) { return part_count(l) == 1; });
}

}  // namespace

PathIntegrator::PathIntegrator(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings)
    : common_{.scene = scene, .settings = settings, .camera_rays = CameraRays(scene, camera, settings)},
      reuse_(shares_paths(settings) && !scene.may_pass && !scene.measured),
      generation_size_(usual_generation_size(settings)) {
  if (settings.integrator == IntegratorKind::direct) common_.settings.max_depth = std::min(settings.max_depth, 1);
  common_.hemisphere = settings.integrator == IntegratorKind::hemisphere;
  common_.splits = asks_for(settings, settings.splitting) && settings.light_samples == 0;
  if (common_.splits && asks_both(scene.lights)) common_.settings.light_samples = 1;
  common_.every_light = common_.settings.light_samples > 0;
  common_.chooses_lights = !common_.every_light && !scene.light_choice.is_certain();
  if (common_.splits && !scene.may_pass) common_.looks = useful_looks(scene);
  if (common_.splits) {
    common_.camera_chains.emplace(scene, common_.camera_rays, settings);
    if (!common_.camera_chains->possible()) common_.camera_chains.reset();
  }
  if (looks_up(settings) && !scene.may_pass && !scene.measured) {
    cache_filler_.emplace(settings, usual_pixel_width(scene, camera, settings));
    common_.cell_side = cache_filler_->cell_side();
  }
  // Photons do not count what they pass straight through.
  if (!uses(settings, settings.photons) || (scene.may_pass && settings.null_counts_as_bounce)) return;
  common_.photons.emplace(scene, camera, common_.settings, worthwhile_samples(settings));
  if (!common_.photons->possible()) common_.photons.reset();
}

std::string_view PathIntegrator::promise() const {
  if (common_.photons && common_.cell_side > 0)
    return "consistent: photons blur caustics, cells light from diffuse surfaces, the less the more samples";
  if (common_.photons) return "consistent: photons blur caustics, the less the more samples";
  if (common_.cell_side > 0) return "consistent: cells blur light from diffuse surfaces, the less the more samples";
  return "unbiased";
}

std::uint32_t PathIntegrator::generation_size() const {
  if (common_.photons || reuse_ || common_.cell_side > 0) return generation_size_;
  return Integrator::generation_size();
}

std::uint64_t PathIntegrator::prepare(std::uint32_t generation) {
  std::uint64_t rays = common_.photons ? common_.photons->trace(generation) : 0;
  if (common_.camera_chains) rays += common_.camera_chains->look_ahead();
  if (common_.cell_side > 0) rays += fill_cache(generation);
  return rays;
}

std::uint64_t PathIntegrator::fill_cache(std::uint32_t generation) {
  common_.cache.reset();
  return cache_filler_->fill(
      generation, scene().geometry, common_.cache,
      [&](int x, int y, std::uint32_t first, std::span<std::optional<RadianceRecord>> records) {
        PixelSample samples[kBatch];
        return PathBatch(common_, x, y, first, std::span(samples).first(records.size()), {}, records).run();
      });
}

int PathIntegrator::block_side() const {
  return reuse_ ? kReuseSide : 1;
}

std::uint64_t PathIntegrator::estimate(const PixelBlock& block, std::uint32_t first, int count,
                                       std::span<PixelSample> samples) const {
  std::vector<SharedPath> shared(reuse_ ? samples.size() : 0);
  std::uint64_t rays = 0;
  for (int pixel = 0; pixel < block.size(); ++pixel) {
    const int x = block.x + pixel % block.width, y = block.y + pixel / block.width;
    const auto begin = static_cast<std::size_t>(pixel) * count;
    const std::span<PixelSample> own = samples.subspan(begin, count);
    rays += PathBatch(common_, x, y, first, own, reuse_ ? std::span(shared).subspan(begin, count) : std::span(shared))
                .run();
    if (common_.camera_chains) rays += common_.camera_chains->follow(x, y, first, own);
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
    rays += share_paths(scene().geometry, std::span(neighbours, n), std::span(targets, n));
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
