#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace etendue {

/// The flags of `etendue render` on their way to RenderOptions: they can come in any order, so what depends on several
/// of them is settled when all are read.
struct RenderFlags {
  RenderOptions options;
  std::optional<int> spp;
  std::optional<AdaptiveSampling> adaptive;
  std::optional<IntegratorKind> integrator;
  std::optional<scene::FilterKind> filter;
  bool hemisphere = false;
  std::optional<std::filesystem::path> env;
  std::optional<float> env_intensity, env_rotation_deg;
  std::optional<bool> env_mirrored;
  std::optional<CameraPlacement> placement;
};

/// Declares the flags; `flags` has to outlive the parse.
void add_render_flags(CLI::App& app, RenderFlags& flags);

/// Declares those that `etendue convert` has as well: which scene, which camera, which picture, which surroundings.
void add_convert_flags(CLI::App& app, RenderFlags& flags);

/// Whether a picture of this size can be made, and what the flags point at lies within it. Throws
/// Error(Failure::usage).
void check_picture(const RenderOptions& options);

/// What the flags mean together. Throws Error(Failure::usage) where they contradict each other.
RenderOptions settled(const RenderFlags& flags);

}  // namespace etendue
