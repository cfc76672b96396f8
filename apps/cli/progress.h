#pragma once

#include <optional>
#include <string>

#include "render/session.h"

namespace etendue {

/// When a render ends before every pixel has all its samples.
struct RenderLimits {
  std::optional<double> seconds;  ///< of rendering
  std::optional<double> noise;    ///< RenderProgress::noise

  /// What part of the work is done, 0 to 1, judged by whichever limit is nearest.
  double fraction_done(const RenderProgress& progress) const;
};

/// One line for a terminal of `columns` characters: percentage, bar, time left, rays a second, noise.
std::string progress_line(const RenderProgress& progress, double fraction_done, int columns);

/// "3.1 %", or "unknown" while there are too few samples.
std::string describe_noise(double noise);

}  // namespace etendue
