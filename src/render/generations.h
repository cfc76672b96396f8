#pragma once

#include <cstdint>

#include "render/settings.h"

/// Samples of a pixel come in generations: photons, cells and blocks of pixels change from one to the next.
namespace etendue {

/// Whether the settings ask for a technique.
bool asks_for(const RenderSettings& settings, Use technique);

/// Whether to try one for light that bounces more than once.
bool uses(const RenderSettings& settings, Use technique);

/// Samples of a pixel that are one generation: one batch, or as many as small pictures need to make it worth while.
std::uint32_t usual_generation_size(const RenderSettings& settings);

/// Samples of a pixel that what is made for a generation is worth: a picture of fewer gets less, but not much less.
/// What few photons do wrong they do to neighbours alike, and denoisers take it for true.
std::uint32_t worthwhile_samples(const RenderSettings& settings);

/// Bytes of the memory limit for one integrator's photons, and for what it records: a picture of two halves has two.
std::uint64_t photon_memory(const RenderSettings& settings);
std::uint64_t record_memory(const RenderSettings& settings);

}  // namespace etendue
