#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <set>

#include "base/error.h"
#include "base/log.h"
#include "base/output_file.h"
#include "base/parallel.h"
#include "camera/settings_file.h"
#include "commands.h"
#include "denoise/denoise.h"
#include "file_names.h"
#include "image/io.h"
#include "interrupt.h"
#include "render/session.h"
#include "render_loop.h"
#include "render_setup.h"
#include "scene_loading.h"
#include "stats.h"
#include "terminal.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

/// "out.exr" → "out_rate.png"
fs::path rate_picture_path(const fs::path& output) {
  return output.parent_path() / (output.stem().string() + "_rate.png");
}

/// Where the adaptive sampling's rates go, each file once.
std::set<fs::path> rate_pictures(const RenderOptions& options) {
  std::set<fs::path> files;
  if (options.settings.adaptive)
    for (const fs::path& output : options.outputs) files.insert(rate_picture_path(output));
  return files;
}

/// Whether --stats names standard output.
bool is_standard_output(const fs::path& file) {
  return file == "-";
}

/// The pictures that a render writes, each once.
std::vector<fs::path> written_pictures(const RenderOptions& options) {
  std::vector<fs::path> files = options.outputs;
  for (const fs::path& rate : rate_pictures(options)) files.push_back(rate);
  return files;
}

/// The other files that it writes.
std::vector<fs::path> written_texts(const RenderOptions& options) {
  std::vector<fs::path> files;
  if (options.save_camera) files.push_back(*options.save_camera);
  if (options.stats && !is_standard_output(*options.stats)) files.push_back(*options.stats);
  return files;
}

std::vector<fs::path> written_files(const RenderOptions& options) {
  std::vector<fs::path> files = written_pictures(options);
  for (const fs::path& text : written_texts(options)) files.push_back(text);
  return files;
}

std::vector<fs::path> read_files(const RenderOptions& options) {
  std::vector<fs::path> files{options.scene};
  if (options.environment) files.push_back(options.environment->file);
  if (options.camera_file) files.push_back(*options.camera_file);
  return files;
}

/// What the scene file names in turn.
std::vector<fs::path> read_files(const scene::SceneDescription& description) {
  std::vector<fs::path> files;
  for (const scene::Texture& texture : description.textures)
    if (const auto* bitmap = std::get_if<scene::BitmapTexture>(&texture.source)) files.push_back(bitmap->file);
  for (const scene::Light& light : description.lights)
    if (const auto* map = std::get_if<scene::EnvironmentLight>(&light.source)) files.push_back(map->file);
  return files;
}

/// Everything that can be known to fail before the long work.
void check_files(const RenderOptions& options, const RenderStats& stats) {
  check_distinct(read_files(options), written_files(options));
  for (const fs::path& picture : written_pictures(options)) check_writable(picture, stats.width, stats.height);
  for (const fs::path& text : written_texts(options)) check_file_writable(text);
  if (options.preview && !terminal_size())
    throw Error(Failure::usage, "--preview needs a terminal, and standard error is none; leave it out");
}

bool needs_light(IntegratorKind integrator) {
  return integrator == IntegratorKind::automatic || integrator == IntegratorKind::path ||
         integrator == IntegratorKind::direct || integrator == IntegratorKind::hemisphere;
}

/// A black picture is explained beforehand.
void tell_missing_light(const RenderOptions& options, const scene::SceneDescription& description) {
  const IntegratorKind integrator = options.settings.integrator;
  if (!needs_light(integrator)) return;
  if (!options.headlight && !has_light(description))
    log_warning("warning: nothing in the scene shines, the picture will be black; add --env FILE or --headlight");
  else if (integrator == IntegratorKind::hemisphere && !has_light_with_extent(description))
    log_warning(
        "warning: --hemisphere meets lights by chance, and all of this scene's are points or single directions: the "
        "picture will be black; use --integrator direct");
}

std::string_view describe(Ending ending) {
  switch (ending) {
    case Ending::complete:
      return "complete";
    case Ending::time_limit:
      return "time limit";
    case Ending::noise_reached:
      return "noise reached";
    case Ending::interrupted:
      break;
  }
  return "interrupted";
}

Picture labelled(Picture picture, const RenderOptions& options, const RenderStats& stats) {
  auto& metadata = picture.metadata;
  metadata["estimator"] = stats.estimator;
  metadata["scene"] = stats.scene;
  metadata["settings"] = options.command_line;
  metadata["version"] = ETENDUE_VERSION;
  metadata["seed"] = std::to_string(stats.seed);
  metadata["time"] = utc_now();
  metadata["render_seconds"] = fmt::format("{:.3f}", stats.render_seconds);
  metadata["samples_per_pixel"] = fmt::format("{:.6g}", stats.samples_per_pixel);
  return picture;
}

/// The noisy picture stays as the channels noisy.{R,G,B}.
Picture without_noise(Picture picture, const RenderSession& session) {
  const std::optional<NoisyPicture> noisy = session.noisy_picture();
  if (!noisy) {
    log_warning(fmt::format("warning: too few samples to denoise, each pixel needs {}: the picture keeps its noise",
                            kMinimumToDenoise));
    return picture;
  }
  Denoised denoised = denoise(*noisy);
  static constexpr const char* kNames[] = {"noisy.R", "noisy.G", "noisy.B"};
  for (int c = 0; c < 3; ++c) {
    Channel& channel = picture.channels.emplace_back(Channel{kNames[c], {}});
    for (const Spectrum& pixel : picture.beauty.pixels()) channel.values.push_back(pixel[c]);
  }
  picture.beauty = std::move(denoised.image);
  picture.metadata["denoised"] = fmt::format("by {}: biased", denoised.by);
  log_info(fmt::format("denoised by {}: the picture is biased", denoised.by));
  return picture;
}

/// Writes all that can be written; the first failure is thrown at the end.
void write_outputs(const RenderOptions& options, const RenderSession& session, const RenderStats& stats) {
  Picture picture = labelled(session.snapshot(), options, stats);
  if (options.settings.for_denoising) picture = without_noise(std::move(picture), session);
  std::exception_ptr failure;
  const auto attempt = [&](auto write) {
    try {
      write();
    } catch (const Error& error) {
      if (failure)
        log_error(fmt::format("error: {}", error.what()));
      else
        failure = std::current_exception();
    }
  };
  for (const fs::path& output : options.outputs)
    attempt([&] { write_picture(output, picture, {options.exposure_stops}); });
  for (const fs::path& path : rate_pictures(options))
    attempt([&] { write_picture(path, {session.sample_rate_picture(), {}, {}}); });
  if (options.stats) attempt([&] { write_stats(*options.stats, stats); });
  if (failure) std::rethrow_exception(failure);
}

void tell_invalid_samples(const RenderProgress& progress) {
  if (progress.invalid_samples == 0) return;
  log_warning(
      fmt::format("warning: samples that were infinite, negative or no number became black ({}, the first: {}); please "
                  "report the scene",
                  counted(progress.invalid_samples, "sample"), progress.first_invalid));
}

void tell_unsampled(const RenderProgress& progress, const RenderStats& stats) {
  if (progress.unsampled_pixels == 0) return;
  const double share =
      static_cast<double>(progress.unsampled_pixels) / (static_cast<double>(stats.width) * stats.height);
  log_warning(
      fmt::format("warning: stopped before every pixel had a sample: {:.2g} % of the picture is black", 100 * share));
}

void tell_ending(Ending ending, const RenderOptions& options, const RenderStats& stats) {
  if (ending == Ending::interrupted) {
    const auto wanted = static_cast<std::size_t>(options.settings.samples_per_pixel);
    const std::string done = fmt::format("{:.3g}", stats.samples_per_pixel);
    log_warning(fmt::format("interrupted at {}{}",
                            wanted < kMostSamplesPerPixel ? fmt::format("{} of {}", done, counted(wanted, "sample"))
                                                          : counted(done, "sample"),
                            options.outputs.empty() ? "" : "; picture written"));
  }
  std::string outputs;
  for (const fs::path& output : options.outputs) outputs += (outputs.empty() ? "" : ", ") + output.string();
  log_info(fmt::format("{}: {} x {}, {} a pixel, noise {}, in {} ({}rays/s)", describe(ending), stats.width,
                       stats.height, counted(fmt::format("{:.4g}", stats.samples_per_pixel), "sample"),
                       describe_noise(stats.noise), as_duration(stats.render_seconds),
                       with_magnitude(static_cast<double>(stats.rays) / std::max(stats.render_seconds, 1e-9))));
  if (stats.estimator != "unbiased") log_info(fmt::format("the estimate is {}", stats.estimator));
  if (!outputs.empty()) log_info(fmt::format("wrote {}", outputs));
  log_debug(fmt::format("{} of processor time for rendering, at most {}B of memory", as_duration(stats.cpu_seconds),
                        with_magnitude(static_cast<double>(peak_memory_bytes()))));
}

RenderStats initial_stats(const RenderOptions& options) {
  const RenderSettings& s = options.settings;
  RenderStats stats;
  stats.scene = options.scene.string();
  stats.threads = options.threads > 0 ? options.threads : hardware_threads();
  stats.width = s.crop ? s.crop->width : s.width;
  stats.height = s.crop ? s.crop->height : s.height;
  stats.seed = s.seed;
  return stats;
}

void add_progress(RenderStats& stats, const RenderProgress& progress) {
  stats.render_seconds = progress.render_seconds;
  stats.rays = progress.rays;
  stats.invalid_samples = progress.invalid_samples;
  stats.noise = progress.noise;
  stats.samples_per_pixel =
      static_cast<double>(progress.samples_done) / (static_cast<double>(stats.width) * stats.height);
}

}  // namespace

int run(const RenderOptions& asked) {
  check_files(asked, initial_stats(asked));
  const ThreadLimit thread_limit(asked.threads);

  Diagnostics diagnostics;
  DiagnosticsPrinter printer(diagnostics);
  const Clock::time_point load_start = Clock::now();
  scene::SceneDescription description = read_description(asked, diagnostics);
  const double load_seconds = seconds_since(load_start);
  printer.print();
  const RenderOptions options = with_file_settings(asked, description);
  RenderStats stats = initial_stats(options);
  stats.load_seconds = load_seconds;
  check_files(options, stats);
  check_distinct(read_files(description), written_files(options));

  const PreparedScene prepared = prepare_scene(options, description, diagnostics);
  printer.print();
  const RenderScene& scene = prepared.scene;
  stats.build_seconds = scene.build_seconds();
  stats.triangles = scene.triangle_count();
  stats.spheres = scene.sphere_count();
  stats.lights = scene.light_count();
  log_debug(
      fmt::format("read in {}, compiled in {}", as_duration(stats.load_seconds), as_duration(stats.build_seconds)));
  tell_missing_light(options, description);
  description = {};

  const Camera camera = with_lens(prepared.camera, options, scene);
  if (options.save_camera)
    write_camera_settings(*options.save_camera, camera, turning_point(camera, scene.bounds()), options.settings.width,
                          options.settings.height);

  RenderSession session(scene, camera, options.settings);
  const bool on_terminal = terminal_size().has_value();
  if (!on_terminal)
    log_info(fmt::format("rendering {}: {}, {}, {}, {} x {}, {}", stats.scene, counted(stats.triangles, "triangle"),
                         counted(stats.spheres, "sphere"), counted(stats.lights, "light"), stats.width, stats.height,
                         counted(static_cast<std::size_t>(stats.threads), "thread")));
  catch_interrupts();
  const double cpu_start = process_cpu_seconds();
  const Ending ending =
      run_render(session, std::int64_t{stats.width} * stats.height, {options.time_limit_seconds, options.noise_target},
                 {on_terminal && !options.quiet, options.preview, {options.exposure_stops}});
  stats.cpu_seconds = process_cpu_seconds() - cpu_start;
  stats.ending = describe(ending);
  stats.estimator = session.estimator();
  const RenderProgress progress = session.progress();
  add_progress(stats, progress);

  tell_invalid_samples(progress);
  tell_unsampled(progress, stats);
  write_outputs(options, session, stats);
  tell_ending(ending, options, stats);
  return ending == Ending::interrupted ? kInterruptedExitCode : 0;
}

}  // namespace etendue
