#include "render/session.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/uninitialized.h"
#include "image/false_color.h"
#include "render/integrator.h"
#include "render/pixel_blocks.h"

namespace etendue {
namespace {

using Clock = std::chrono::steady_clock;

/// What a pass without a given number of samples should last: short enough to steer by, long enough to start cheaply.
constexpr double kPassSeconds = 0.5;

/// What the seeds of a picture's two halves differ by.
constexpr std::uint64_t kSecondHalf = 0x9e3779b97f4a7c15u;

/// In metres; as far as geometry may reach.
constexpr float kFarthestCamera = 1e12f;

/// `samples` rounded up to where a batch ends: after 1, 4 and 16 samples, then after every 16. Batches lie between
/// these counts whatever the passes, so that which samples travel together does not depend on how a render is split;
/// the first are small, so that even a render that is soon stopped has seen every pixel.
std::uint32_t whole_batches(std::uint32_t samples) {
  constexpr std::uint32_t kBatch = Geometry::kBatch;
  if (samples <= 1) return samples;
  if (samples <= 4) return 4;
  return (samples + kBatch - 1) / kBatch * kBatch;
}

/// The next count of samples at which the adaptive criterion looks at a pixel.
std::uint32_t next_check(std::uint32_t samples, const RenderSettings& settings) {
  const auto limit = static_cast<std::uint32_t>(settings.samples_per_pixel);
  if (!settings.adaptive) return limit;
  const auto batch = static_cast<std::uint32_t>(settings.adaptive->batch);
  return std::min(limit, (samples / batch + 1) * batch);
}

bool has_settled(const PixelSums& pixel, const AdaptiveSampling& adaptive) {
  return 1.96 * pixel.luminance_error() <= adaptive.tolerance * pixel.mean_luminance();
}

bool is_valid(const Spectrum& radiance) {
  return is_finite(radiance) && radiance.r >= 0 && radiance.g >= 0 && radiance.b >= 0;
}

/// Scaled down to the luminance `most`, if it has more.
Spectrum clamped(const Spectrum& radiance, float most) {
  const float luminance = radiance.luminance();
  return luminance > most ? radiance * (most / luminance) : radiance;
}

}  // namespace

/// What a tile adds to the picture's counts, in one go: counters that threads share are dear.
struct TileCounts {
  std::uint64_t rays = 0, samples = 0, samples_saved = 0, finished_pixels = 0;
};

/// Columns and rows of blocks, ends not included.
struct Tile {
  int column0, column1, row0, row1;
};

struct RenderSession::Impl {
  RenderScene scene;
  RenderSettings settings;
  CropWindow window;
  std::unique_ptr<Integrator> integrator;
  std::unique_ptr<Integrator> second_integrator;  ///< of the second half of the samples, if it is to be independent
  Film film;
  PixelBlocks blocks;

  std::atomic<std::uint64_t> rays{0}, samples_done{0}, samples_saved{0}, invalid_samples{0};
  std::atomic<std::size_t> finished_pixels{0}, unsampled_pixels{0};
  std::mutex first_invalid_mutex;
  std::string first_invalid;
  std::atomic<double> seconds{0}, noise{std::numeric_limits<double>::infinity()};  // as of the last pass
  int pass_samples = 1;
  std::optional<std::uint32_t> prepared;  ///< generation of the integrator

  Impl(RenderScene s, const Camera& camera, const RenderSettings& chosen)
      : scene(std::move(s)),
        settings(chosen),
        window(chosen.crop.value_or(CropWindow{0, 0, chosen.width, chosen.height})),
        integrator(make_integrator(scene.data(), camera, settings)),
        film(window.width, window.height, chosen.for_denoising, chosen.doubts_outliers),
        blocks(integrator->block_side(), settings, window) {
    if (!settings.for_denoising) return;
    RenderSettings other = settings;
    other.seed ^= kSecondHalf;
    second_integrator = make_integrator(scene.data(), camera, other);
  }

  std::uint32_t fewest_samples() const;
  void prepare(std::uint32_t generation);
  void render_to(std::uint32_t target, const std::stop_token& stop);
  void render_tile(const Tile& tile, std::uint32_t target, const std::stop_token& stop);
  void render_block(const PixelBlock& block, std::uint32_t target, TileCounts& counts);
  void add_samples(const PixelBlock& block, std::uint32_t first, std::uint32_t count, TileCounts& counts);
  void finish(const PixelBlock& block, TileCounts& counts);
  PixelBlock visible(const PixelBlock& block) const;
  void note_invalid(int x, int y, std::uint32_t sample);
};

void RenderSession::Impl::note_invalid(int x, int y, std::uint32_t sample) {
  ++invalid_samples;
  const std::lock_guard lock(first_invalid_mutex);
  if (first_invalid.empty()) first_invalid = fmt::format("pixel ({}, {}), sample {}", x, y, sample);
}

/// Of the pixels that get more.
std::uint32_t RenderSession::Impl::fewest_samples() const {
  auto fewest = static_cast<std::uint32_t>(settings.samples_per_pixel);
  for (const PixelSums& pixel : film.pixels())
    if (!pixel.finished) fewest = std::min(fewest, pixel.samples);
  return fewest;
}

/// Adds samples first, first + 1, … to the block's pixels within the window. For denoising, every other one belongs to
/// the second half, which has sequences of its own.
void RenderSession::Impl::add_samples(const PixelBlock& block, std::uint32_t first, std::uint32_t count,
                                      TileCounts& counts) {
  const auto of_first_half = [&](std::uint32_t samples) { return second_integrator ? (samples + 1) / 2 : samples; };
  const std::uint32_t begin = of_first_half(first), here = of_first_half(first + count) - begin, there = count - here;
  const auto pixels = static_cast<std::size_t>(block.size());
  UninitializedArray<PixelSample, Geometry::kBatch * PixelBlock::kMost> batch;
  for (std::size_t i = 0; i < pixels * count; ++i) batch.emplace(i);
  const std::span first_half(&batch[0], pixels * here), second_half(&batch[0] + pixels * here, pixels * there);
  if (here > 0) counts.rays += integrator->estimate(block, begin, static_cast<int>(here), first_half);
  if (there > 0) counts.rays += second_integrator->estimate(block, first - begin, static_cast<int>(there), second_half);
  const PixelBlock seen = visible(block);
  for (int y = seen.y; y < seen.y + seen.height; ++y)
    for (int x = seen.x; x < seen.x + seen.width; ++x) {
      const auto pixel = static_cast<std::size_t>((y - block.y) * block.width + x - block.x);
      UninitializedArray<PixelSample, Geometry::kBatch> gathered;
      for (std::uint32_t i = 0; i < count; ++i)
        gathered.emplace(i, i < here ? first_half[pixel * here + i] : second_half[pixel * there + i - here]);
      const std::span own(&gathered[0], count);
      for (std::uint32_t i = 0; i < count; ++i) {
        if (is_valid(own[i].radiance)) continue;
        note_invalid(x, y, first + i);
        own[i].radiance = Spectrum(0);
      }
      if (settings.clamp)
        for (PixelSample& sample : own) sample.radiance = clamped(sample.radiance, *settings.clamp);
      film.add(x - window.x, y - window.y, own, here);
    }
  counts.samples += static_cast<std::uint64_t>(seen.size()) * count;
}

/// Brings the pixels of a block to `target` samples. They all have had the same number so far; those outside the window
/// are not kept.
void RenderSession::Impl::render_block(const PixelBlock& block, std::uint32_t target, TileCounts& counts) {
  const PixelBlock seen = visible(block);
  const PixelSums& pixel = film.at(seen.x - window.x, seen.y - window.y);
  while (pixel.samples < target && !pixel.finished) {
    const std::uint32_t check = next_check(pixel.samples, settings);
    const std::uint32_t end = std::min({target, check, whole_batches(pixel.samples + 1)});
    add_samples(block, pixel.samples, end - pixel.samples, counts);
    if (end == check && settings.adaptive && has_settled(pixel, *settings.adaptive)) finish(seen, counts);
    if (end >= static_cast<std::uint32_t>(settings.samples_per_pixel)) finish(seen, counts);
  }
}

void RenderSession::Impl::finish(const PixelBlock& block, TileCounts& counts) {
  for (int y = block.y; y < block.y + block.height; ++y)
    for (int x = block.x; x < block.x + block.width; ++x) {
      PixelSums& pixel = film.at(x - window.x, y - window.y);
      if (pixel.finished) continue;
      pixel.finished = true;
      ++counts.finished_pixels;
      counts.samples_saved += static_cast<std::uint32_t>(settings.samples_per_pixel) - pixel.samples;
    }
}

/// The part of a block that lies in the window.
PixelBlock RenderSession::Impl::visible(const PixelBlock& b) const {
  const int x0 = std::max(b.x, window.x), y0 = std::max(b.y, window.y);
  return {x0, y0, std::min(b.x + b.width, window.x + window.width) - x0,
          std::min(b.y + b.height, window.y + window.height) - y0};
}

void RenderSession::Impl::render_tile(const Tile& tile, std::uint32_t target, const std::stop_token& stop) {
  TileCounts counts;
  for (int row = tile.row0; row < tile.row1; ++row)
    for (int column = tile.column0; column < tile.column1; ++column) {
      const PixelBlock block = blocks.block(column, row);
      const PixelBlock seen = visible(block);
      if (film.at(seen.x - window.x, seen.y - window.y).finished) continue;
      if (stop.stop_requested()) break;
      render_block(block, target, counts);
    }
  rays += counts.rays;
  samples_done += counts.samples;
  samples_saved += counts.samples_saved;
  finished_pixels += counts.finished_pixels;
}

RenderSession::RenderSession(RenderScene scene, const Camera& camera, const RenderSettings& settings) {
  const CropWindow crop = settings.crop.value_or(CropWindow{0, 0, settings.width, settings.height});
  if (settings.width < 1 || settings.height < 1 || settings.samples_per_pixel < 1 || settings.tile_size < 1)
    throw Error(Failure::usage, "width, height, samples per pixel and tile size must be at least 1");
  if (!(max_abs_component(camera.to_world.origin) <= kFarthestCamera))
    throw Error(Failure::input,
                "the camera stands farther than 1e12 m from the origin, or nowhere; check its position");
  if (settings.memory_limit < kLeastMemory) throw Error(Failure::usage, "the memory limit must be at least 1 MiB");
  if (settings.adaptive && settings.adaptive->batch < 1)
    throw Error(Failure::usage, "an adaptive batch needs at least 1 sample");
  if (crop.x < 0 || crop.y < 0 || crop.width < 1 || crop.height < 1 || crop.x > settings.width - crop.width ||
      crop.y > settings.height - crop.height)
    throw Error(Failure::usage, fmt::format("the crop window {}×{} at ({}, {}) does not lie within the {}×{} picture",
                                            crop.width, crop.height, crop.x, crop.y, settings.width, settings.height));
  impl_ = std::make_unique<Impl>(std::move(scene), camera, settings);
}

RenderSession::~RenderSession() = default;
RenderSession::RenderSession(RenderSession&&) noexcept = default;
RenderSession& RenderSession::operator=(RenderSession&&) noexcept = default;

void RenderSession::Impl::prepare(std::uint32_t generation) {
  rays += integrator->prepare(generation);
  if (second_integrator) rays += second_integrator->prepare(generation);
  blocks.move(generation);
  prepared = generation;
}

/// Brings all pixels that get more to `target` samples; they are of one generation.
void RenderSession::Impl::render_to(std::uint32_t target, const std::stop_token& stop) {
  const int side = std::max(1, settings.tile_size / blocks.side());  // of a tile, in blocks
  const int columns = (blocks.columns() + side - 1) / side, rows = (blocks.rows() + side - 1) / side;
  parallel_for(static_cast<std::size_t>(columns) * rows, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int column = static_cast<int>(i) % columns * side, row = static_cast<int>(i) / columns * side;
      render_tile({column, std::min(column + side, blocks.columns()), row, std::min(row + side, blocks.rows())}, target,
                  stop);
    }
  });
}

void RenderSession::render_pass(const std::stop_token& stop, int samples) {
  Impl& s = *impl_;
  const auto start = Clock::now();
  const auto n = static_cast<std::uint32_t>(samples > 0 ? samples : s.pass_samples);
  std::uint32_t done = s.fewest_samples();  // an earlier pass may have been stopped within a generation
  const std::uint32_t target =
      std::min(whole_batches(done + n), static_cast<std::uint32_t>(s.settings.samples_per_pixel));
  const std::uint32_t size = s.integrator->generation_size();
  while (done < target && !stop.stop_requested()) {
    const std::uint32_t generation = done / size;
    if (generation != s.prepared) s.prepare(generation);
    done = target / size == generation ? target : std::min(target, (generation + 1) * size);
    s.render_to(done, stop);
  }
  const double took = std::chrono::duration<double>(Clock::now() - start).count();
  s.seconds = s.seconds + took;
  s.noise = s.film.noise();
  s.unsampled_pixels = s.film.unsampled_pixels();
  if (samples == 0 && took < kPassSeconds) s.pass_samples = std::min(s.pass_samples * 2, 1 << 12);
}

std::string RenderSession::estimator() const {
  const RenderSettings& s = impl_->settings;
  const std::string outliers = "lone bright samples count for less, fewer with more samples";
  if (s.clamp)
    return fmt::format("biased: no sample is brighter than {:g}{}", *s.clamp, s.doubts_outliers ? ", " + outliers : "");
  if (s.doubts_outliers) return "biased: " + outliers;
  return std::string(impl_->integrator->promise());
}

bool RenderSession::finished() const {
  return impl_->finished_pixels == impl_->film.pixels().size();
}

RenderProgress RenderSession::progress() const {
  const Impl& s = *impl_;
  RenderProgress p;
  p.samples_done = s.samples_done;
  p.samples_total = static_cast<std::uint64_t>(s.settings.samples_per_pixel) * s.film.pixels().size() - s.samples_saved;
  p.rays = s.rays;
  p.invalid_samples = s.invalid_samples;
  p.render_seconds = s.seconds;
  p.noise = s.noise;
  p.unsampled_pixels = s.unsampled_pixels;
  {
    const std::lock_guard lock(impl_->first_invalid_mutex);
    p.first_invalid = s.first_invalid;
  }
  return p;
}

Picture RenderSession::snapshot() const {
  return impl_->film.picture();
}
Image RenderSession::beauty() const {
  return impl_->film.beauty();
}

std::optional<NoisyPicture> RenderSession::noisy_picture() const {
  return impl_->film.noisy_picture();
}

Image RenderSession::sample_rate_picture() const {
  const Film& film = impl_->film;
  Image image(film.width(), film.height());
  for (std::size_t i = 0; i < film.pixels().size(); ++i)
    image.pixels()[i] = rate_color(static_cast<float>(film.pixels()[i].samples) /
                                   static_cast<float>(impl_->settings.samples_per_pixel));
  return image;
}

}  // namespace etendue
