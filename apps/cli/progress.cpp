#include "progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "terminal.h"

namespace etendue {

double RenderLimits::fraction_done(const RenderProgress& progress) const {
  double fraction = progress.samples_total > 0
                        ? static_cast<double>(progress.samples_done) / static_cast<double>(progress.samples_total)
                        : 0;
  if (seconds) fraction = std::max(fraction, progress.render_seconds / *seconds);
  if (noise && std::isfinite(progress.noise) && progress.noise > 0)
    fraction = std::max(fraction, (*noise / progress.noise) * (*noise / progress.noise));  // error ∝ 1/√samples
  return std::clamp(fraction, 0.0, 1.0);
}

std::string progress_line(const RenderProgress& progress, double fraction_done, int columns) {
  static constexpr int kWidestBar = 30;
  const double elapsed = progress.render_seconds;
  const std::string left =
      fraction_done > 0 && elapsed > 0.2 ? as_duration(elapsed * (1 - fraction_done) / fraction_done) + " left" : "";
  const double rays_per_second = elapsed > 0 ? static_cast<double>(progress.rays) / elapsed : 0;
  const std::string numbers =
      fmt::format("  {}  {}rays/s  noise {}", left, with_magnitude(rays_per_second), describe_noise(progress.noise));
  const std::string percent = fmt::format("{:3.0f} % ", std::floor(fraction_done * 100));

  const int room = columns - 1 - static_cast<int>(percent.size() + numbers.size());
  const int width = std::clamp(room, 0, kWidestBar);
  const int full = static_cast<int>(std::lround(fraction_done * width));
  std::string bar;
  for (int i = 0; i < width; ++i) bar += i < full ? "█" : "░";
  return room < 0 ? percent : percent + bar + numbers;
}

std::string describe_noise(double noise) {
  return std::isfinite(noise) ? fmt::format("{:.2g} %", 100 * noise) : "unknown";
}

}  // namespace etendue
