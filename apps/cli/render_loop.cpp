#include "render_loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "interrupt.h"
#include "preview.h"
#include "terminal.h"

namespace etendue {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPollInterval = 20ms;
constexpr auto kRedrawInterval = 100ms;
constexpr auto kRepaintInterval = 250ms;
constexpr double kSamplesBeforeNoiseIsTrusted = 16;  // a pixel; fewer give no useful variance

/// Stops a pass when the time is over or the user asks for it, and keeps the progress line alive, from a thread of its
/// own.
class Watch {
 public:
  Watch(const RenderSession& session, const RenderLimits& limits, bool progress_line, std::stop_source& render_stop)
      : session_(session),
        limits_(limits),
        progress_line_(progress_line),
        render_stop_(render_stop),
        thread_([this](const std::stop_token& done) { run(done); }) {}

  ~Watch() {
    thread_.request_stop();
    thread_.join();
    if (progress_line_) write_terminal("\r\x1b[K");
  }

  bool time_is_over() const { return limits_.seconds && seconds_since_start() >= *limits_.seconds; }

  /// Calls `paint` while nothing else writes to the terminal.
  template <typename Paint>
  void with_terminal(Paint paint) {
    const std::lock_guard lock(mutex_);
    paint();
  }

 private:
  void run(const std::stop_token& done) {
    Clock::time_point next_redraw = start_;
    std::unique_lock lock(mutex_);
    while (!done.stop_requested()) {
      if (interrupted() || time_is_over()) render_stop_.request_stop();
      if (progress_line_ && Clock::now() >= next_redraw) {
        draw_progress_line();
        next_redraw = Clock::now() + kRedrawInterval;
      }
      wake_.wait_for(lock, done, kPollInterval, [] { return false; });
    }
  }

  void draw_progress_line() const {
    RenderProgress progress = session_.progress();
    progress.render_seconds = seconds_since_start();  // a session counts whole passes only
    const int columns = terminal_size().value_or(TerminalSize{80, 24}).columns;
    write_terminal("\r\x1b[K" + progress_line(progress, limits_.fraction_done(progress), columns));
  }

  double seconds_since_start() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  const Clock::time_point start_ = Clock::now();
  const RenderSession& session_;
  const RenderLimits& limits_;
  const bool progress_line_;
  std::stop_source& render_stop_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;  // last: it uses all of the above
};

/// Repaints the preview now and then.
class PreviewPainter {
 public:
  PreviewPainter(const RenderDisplay& display) {
    if (const auto terminal = terminal_size(); display.preview && terminal) preview_.emplace(*terminal, display.tone);
  }

  void paint_if_due(const RenderSession& session, Watch& watch, bool always) {
    if (!preview_ || (!always && Clock::now() < next_)) return;
    const Image picture = session.beauty();
    watch.with_terminal([&] { preview_->paint(picture); });
    next_ = Clock::now() + kRepaintInterval;
  }

 private:
  std::optional<Preview> preview_;
  Clock::time_point next_;
};

/// How many samples the next pass should add so that it ends near the wanted noise; 0: the session's choice.
int samples_until(double noise_target, const RenderProgress& progress, double samples_so_far) {
  if (samples_so_far < kSamplesBeforeNoiseIsTrusted || !std::isfinite(progress.noise)) return 0;
  const double factor = std::min(2.0, std::pow(progress.noise / noise_target, 2));
  return std::max(1, static_cast<int>(std::ceil(samples_so_far * (factor - 1))));
}

}  // namespace

Ending run_render(RenderSession& session, std::int64_t pixel_count, const RenderLimits& limits,
                  const RenderDisplay& display) {
  std::stop_source stop;
  Watch watch(session, limits, display.progress_line, stop);
  PreviewPainter preview(display);
  int pass_samples = 0;
  while (!session.finished()) {
    session.render_pass(stop.get_token(), pass_samples);
    preview.paint_if_due(session, watch, session.finished() || stop.stop_requested());
    if (session.finished()) break;
    if (interrupted()) return Ending::interrupted;
    if (watch.time_is_over()) return Ending::time_limit;
    if (limits.noise) {
      const RenderProgress progress = session.progress();
      const double samples = static_cast<double>(progress.samples_done) / static_cast<double>(pixel_count);
      if (samples >= kSamplesBeforeNoiseIsTrusted && progress.noise <= *limits.noise) return Ending::noise_reached;
      pass_samples = samples_until(*limits.noise, progress, samples);
    }
  }
  return Ending::complete;
}

}  // namespace etendue
