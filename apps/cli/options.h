#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/log.h"
#include "camera/placement.h"
#include "formats/formats.h"
#include "render/render_scene.h"
#include "render/settings.h"
#include "scene/scene.h"

namespace etendue {

/// The most samples a pixel can get: what a render has that only time or noise ends.
inline constexpr int kMostSamplesPerPixel = 1 << 20;

/// A pixel of the whole picture.
struct Pixel {
  int x = 0, y = 0;
};

/// What `etendue render` was asked for. Absent optionals were not given.
struct RenderOptions {
  std::filesystem::path scene;
  ReadOptions read;
  std::vector<std::filesystem::path> outputs;
  RenderSettings settings;
  /// What of `settings` was asked for: the scene file has no say in it.
  struct Given {
    bool size = false, crop = false, samples = false, depth = false, filter = false;
  } given;
  CompileOptions compile;
  std::optional<scene::EnvironmentLight> environment;
  bool headlight = false;

  CameraPlacement placement = CameraPlacement::automatic;
  std::optional<std::filesystem::path> camera_file, save_camera;
  std::optional<float> lens_radius, focal_distance;
  std::optional<Pixel> focus_at;
  int blades = 0;
  float blade_rotation_deg = 0;

  float exposure_stops = 0;
  std::optional<double> time_limit_seconds;
  std::optional<double> noise_target;  ///< relative standard error, as in RenderProgress::noise
  int threads = 0;                     ///< 0: all of the machine's
  bool preview = false;
  bool quiet = false;  ///< no progress line
  std::optional<std::filesystem::path> stats;
  std::string command_line;  ///< as given, for the picture's metadata
};

struct InfoOptions {
  std::filesystem::path scene;
  ReadOptions read;
  bool json = false;
};

struct ConvertOptions {
  RenderOptions render;  ///< the scene, its surroundings and the camera that a render would use
  std::filesystem::path output;
};

struct EnvmapOptions {
  std::filesystem::path file;
  std::optional<std::filesystem::path> debug, pdf;
};

struct DiffOptions {
  std::filesystem::path a, b;
  bool variance = false;
  std::optional<std::filesystem::path> heatmap;
  std::optional<double> fail_above;  ///< relative mean squared error
};

/// Text asked for with --help or --version.
struct PrintText {
  std::string text;
};

struct CommandLine {
  LogLevel log_level = LogLevel::normal;
  std::variant<PrintText, RenderOptions, InfoOptions, ConvertOptions, EnvmapOptions, DiffOptions> command;
};

/// Reads and checks the program's arguments. Throws Error(Failure::usage) with the remedy.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace etendue
