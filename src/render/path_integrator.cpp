#include "render/path_integrator.h"

#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "render/debug_integrators.h"
#include "render/pixel_width.h"
#include "render/volume_path_integrator.h"
#include "sampling/hash.h"

namespace etendue {
namespace {

constexpr int kBatch = Geometry::kBatch;

/// Of the pixels, one in so many is sampled for the cache, as often as all are for the picture; of large pictures so
/// many at most.
constexpr std::uint64_t kPixelsPerRecord = 8, kMostRecorded = 1 << 16;
/// Of the first generation's cells, in pixels; where fewer pixels are sampled, cells are larger.
constexpr float kCellInPixels = 8;
/// Their sides ∝ (generation + 1)^−⅙.
constexpr float kShrinking = -1.0f / 6;

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

/// Samples of a pixel that what is made for a generation is worth: a picture of fewer gets less, but not much less.
/// What few photons do wrong they do to neighbours alike, and denoisers take it for true.
std::uint32_t worthwhile_samples(const RenderSettings& settings) {
  const std::uint32_t size = usual_generation_size(settings);
  if (settings.for_denoising) return size;
  return std::clamp(static_cast<std::uint32_t>(settings.samples_per_pixel), size / 4, size);
}

std::uint64_t pixels_per_record(const RenderSettings& settings) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  const std::uint64_t usual = kPixelsPerRecord * usual_generation_size(settings) / worthwhile_samples(settings);
  return std::max(usual, (pixels + kMostRecorded - 1) / kMostRecorded);
}

/// What neighbouring cells know is not independent either; and light needs two bounces between surfaces to be worth
/// looking up.
bool looks_up(const RenderSettings& settings) {
  if (settings.max_depth < 3 || (settings.for_denoising && settings.cache != Use::on)) return false;
  return uses(settings, settings.cache);
}

}  // namespace

PathIntegrator::PathIntegrator(const RenderScene::Data& scene, const Camera& camera, const RenderSettings& settings)
    : common_{.scene = scene, .settings = settings, .camera_rays = CameraRays(scene, camera, settings)},
      reuse_(shares_paths(settings) && !scene.may_pass && !scene.measured),
      generation_size_(usual_generation_size(settings)) {
  if (settings.integrator == IntegratorKind::direct) common_.settings.max_depth = std::min(settings.max_depth, 1);
  common_.every_light = settings.light_samples > 0;
  common_.hemisphere = settings.integrator == IntegratorKind::hemisphere;
  common_.splits = settings.integrator == IntegratorKind::automatic && !common_.every_light;
  common_.looks = common_.splits && !scene.may_pass;
  if (looks_up(settings) && !scene.may_pass && !scene.measured)
    common_.cell_side = kCellInPixels * usual_pixel_width(scene, camera, settings) *
                        std::sqrt(static_cast<float>(pixels_per_record(settings)) / kPixelsPerRecord);
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
  if (common_.cell_side > 0) rays += fill_cache(generation);
  return rays;
}

std::uint64_t PathIntegrator::fill_cache(std::uint32_t generation) {
  common_.cache.reset();
  const auto width = static_cast<std::uint64_t>(common_.settings.width);
  const std::uint64_t pixels = width * static_cast<std::uint64_t>(common_.settings.height);
  const std::uint64_t per_record = pixels_per_record(common_.settings);
  const std::uint64_t chosen = (pixels + per_record - 1) / per_record;
  std::vector<std::optional<RadianceRecord>> found(chosen * generation_size_);
  std::vector<std::uint64_t> rays(chosen);
  parallel_for(chosen, 64, [&](std::size_t begin, std::size_t end) {
    PixelSample samples[kBatch];
    for (std::size_t c = begin; c < end; ++c) {
      const std::uint32_t one =
          hash_combine(generation, static_cast<std::uint32_t>(c)) % static_cast<std::uint32_t>(per_record);
      const std::uint64_t pixel = std::min(c * per_record + one, pixels - 1);
      for (std::uint32_t first = 0; first < generation_size_; first += kBatch)
        rays[c] += PathBatch(common_, static_cast<int>(pixel % width), static_cast<int>(pixel / width),
                             generation * generation_size_ + first, samples, {},
                             std::span(found).subspan(c * generation_size_ + first, kBatch))
                       .run();
    }
  });
  std::vector<RadianceRecord> records;
  for (const std::optional<RadianceRecord>& record : found)
    if (record) records.push_back(*record);
  const float side = common_.cell_side * std::pow(static_cast<float>(generation + 1), kShrinking);
  const auto offset = [&](std::uint32_t axis) { return to_unit_float(hash_combine(generation, axis)); };
  common_.cache.emplace(records, scene().geometry, side, Vec3(offset(0), offset(1), offset(2)));
  return std::accumulate(rays.begin(), rays.end(), common_.cache->rays());
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
    rays +=
        PathBatch(common_, block.x + pixel % block.width, block.y + pixel / block.width, first,
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
