#include "render/session.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>

#include "base/error.h"
#include "base/parallel.h"
#include "image/false_color.h"
#include "render/integrator.h"

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

}  // namespace

/// What a tile adds to the picture's counts, in one go: counters that threads share are dear.
struct TileCounts {
  std::uint64_t rays = 0, samples = 0, samples_saved = 0, finished_pixels = 0;
};

struct RenderSession::Impl {
  RenderScene scene;
  RenderSettings settings;
  CropWindow window;
  std::unique_ptr<Integrator> integrator;
  std::unique_ptr<Integrator> second_integrator;  ///< of the second half of the samples, if it is to be independent
  Film film;

  std::atomic<std::uint64_t> rays{0}, samples_done{0}, samples_saved{0}, invalid_samples{0};
  std::atomic<std::size_t> finished_pixels{0}, unsampled_pixels{0};
  std::mutex first_invalid_mutex;
  std::string first_invalid;
  std::atomic<double> seconds{0}, noise{std::numeric_limits<double>::infinity()};  // as of the last pass
  int pass_samples = 1;

  Impl(RenderScene s, const Camera& camera, const RenderSettings& chosen)
      : scene(std::move(s)),
        settings(chosen),
        window(chosen.crop.value_or(CropWindow{0, 0, chosen.width, chosen.height})),
        integrator(make_integrator(scene.data(), camera, settings)),
        film(window.width, window.height, chosen.for_denoising) {
    if (!settings.for_denoising) return;
    RenderSettings other = settings;
    other.seed ^= kSecondHalf;
    second_integrator = make_integrator(scene.data(), camera, other);
  }

  void add_samples(int x, int y, std::uint32_t first, std::uint32_t count, TileCounts& counts);
  void render_tile(int x0, int y0, std::uint32_t samples, const std::stop_token& stop);
  void render_pixel(int x, int y, std::uint32_t samples, TileCounts& counts);
  void note_invalid(int x, int y, std::uint32_t sample);
};

void RenderSession::Impl::note_invalid(int x, int y, std::uint32_t sample) {
  ++invalid_samples;
  const std::lock_guard lock(first_invalid_mutex);
  if (first_invalid.empty()) first_invalid = fmt::format("pixel ({}, {}), sample {}", x, y, sample);
}

/// Adds samples first, first + 1, … to one pixel of the window. For denoising, every other one belongs to the second
/// half, which has sequences of its own.
void RenderSession::Impl::add_samples(int x, int y, std::uint32_t first, std::uint32_t count, TileCounts& counts) {
  PixelSample batch[Geometry::kBatch];
  const auto of_first_half = [&](std::uint32_t samples) { return second_integrator ? (samples + 1) / 2 : samples; };
  const std::uint32_t begin = of_first_half(first), here = of_first_half(first + count) - begin;
  const std::span samples(batch, count);
  if (here > 0) counts.rays += integrator->estimate(window.x + x, window.y + y, begin, samples.first(here));
  if (here < count)
    counts.rays += second_integrator->estimate(window.x + x, window.y + y, first - begin, samples.subspan(here));
  for (std::uint32_t i = 0; i < count; ++i) {
    if (is_valid(batch[i].radiance)) continue;
    note_invalid(window.x + x, window.y + y, first + i);
    batch[i].radiance = Spectrum(0);
  }
  film.add(x, y, samples, here);
}

/// Adds up to `samples` samples to one pixel of the window.
void RenderSession::Impl::render_pixel(int x, int y, std::uint32_t samples, TileCounts& counts) {
  PixelSums& pixel = film.at(x, y);
  const std::uint32_t before = pixel.samples;
  const std::uint32_t target =
      std::min(whole_batches(before + samples), static_cast<std::uint32_t>(settings.samples_per_pixel));
  while (pixel.samples < target && !pixel.finished) {
    const std::uint32_t check = next_check(pixel.samples, settings);
    const std::uint32_t end = std::min(target, check);
    const auto count = std::min(end, whole_batches(pixel.samples + 1)) - pixel.samples;
    add_samples(x, y, pixel.samples, count, counts);
    if (pixel.samples == check && settings.adaptive && has_settled(pixel, *settings.adaptive)) pixel.finished = true;
    if (pixel.samples >= static_cast<std::uint32_t>(settings.samples_per_pixel)) pixel.finished = true;
  }
  counts.samples += pixel.samples - before;
  if (pixel.finished) {
    ++counts.finished_pixels;
    counts.samples_saved += static_cast<std::uint32_t>(settings.samples_per_pixel) - pixel.samples;
  }
}

void RenderSession::Impl::render_tile(int x0, int y0, std::uint32_t samples, const std::stop_token& stop) {
  TileCounts counts;
  const int x1 = std::min(x0 + settings.tile_size, film.width()), y1 = std::min(y0 + settings.tile_size, film.height());
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      if (film.at(x, y).finished) continue;
      if (stop.stop_requested()) break;
      render_pixel(x, y, samples, counts);
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

void RenderSession::render_pass(std::stop_token stop, int samples) {
  Impl& s = *impl_;
  const auto start = Clock::now();
  const int n = samples > 0 ? samples : s.pass_samples;
  const int tile = s.settings.tile_size;
  const int columns = (s.film.width() + tile - 1) / tile, rows = (s.film.height() + tile - 1) / tile;
  parallel_for(static_cast<std::size_t>(columns) * rows, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int t = static_cast<int>(i);
      s.render_tile(t % columns * tile, t / columns * tile, static_cast<std::uint32_t>(n), stop);
    }
  });
  const double took = std::chrono::duration<double>(Clock::now() - start).count();
  s.seconds = s.seconds + took;
  s.noise = s.film.noise();
  s.unsampled_pixels = s.film.unsampled_pixels();
  if (samples == 0 && took < kPassSeconds) s.pass_samples = std::min(s.pass_samples * 2, 1 << 12);
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
