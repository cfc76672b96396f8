#pragma once

#include <cstdint>

#include "image/io.h"
#include "progress.h"
#include "render/session.h"

namespace etendue {

/// Why a render ended.
enum class Ending { complete, time_limit, noise_reached, interrupted };

/// What the user sees of a render while it runs.
struct RenderDisplay {
  bool progress_line = false;  ///< on the terminal that standard error is
  bool preview = false;        ///< the same
  ToneMapping tone;            ///< of the preview
};

/// Renders the session's picture of `pixel_count` pixels until it is finished, a limit is reached or the user
/// interrupts.
Ending run_render(RenderSession& session, std::int64_t pixel_count, const RenderLimits& limits,
                  const RenderDisplay& display);

}  // namespace etendue
