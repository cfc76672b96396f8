#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace etendue {

/// What a render cost, for --stats and for the closing line.
struct RenderStats {
  std::string scene;
  std::size_t triangles = 0, spheres = 0, lights = 0;
  int threads = 0, width = 0, height = 0;  ///< of the rendered part
  std::uint64_t seed = 0;
  double load_seconds = 0;    ///< reading the files
  double build_seconds = 0;   ///< compiling the scene
  double render_seconds = 0;  ///< wall time of rendering
  double cpu_seconds = 0;     ///< user and system time of all threads while rendering
  std::uint64_t rays = 0;
  double samples_per_pixel = 0;
  std::uint64_t invalid_samples = 0;
  double noise = 0;       ///< null in JSON if there were too few samples to tell
  std::string ending;     ///< "complete", "time limit", …
  std::string estimator;  ///< "unbiased", or what it is instead and why
};

/// User and system time of this process so far, all threads, in seconds.
double process_cpu_seconds();

/// The most memory that this process ever held.
std::uint64_t peak_memory_bytes();

/// Writes the numbers as one JSON object, to standard output if the path is "-". Throws Error(Failure::output).
void write_stats(const std::filesystem::path& path, const RenderStats& stats);

}  // namespace etendue
