#include "stats.h"

#include <sys/resource.h>

#include <nlohmann/json.hpp>
#include <span>

#include "base/output_file.h"
#include "terminal.h"

namespace etendue {
namespace {

rusage process_usage() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage;
}

double to_seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

double process_cpu_seconds() {
  const rusage usage = process_usage();
  return to_seconds(usage.ru_utime) + to_seconds(usage.ru_stime);
}

std::uint64_t peak_memory_bytes() {
  return static_cast<std::uint64_t>(process_usage().ru_maxrss) * 1024;
}

void write_stats(const std::filesystem::path& path, const RenderStats& s) {
  const nlohmann::ordered_json json = {
      {"version", ETENDUE_VERSION},
      {"scene", s.scene},
      {"triangles", s.triangles},
      {"spheres", s.spheres},
      {"lights", s.lights},
      {"width", s.width},
      {"height", s.height},
      {"seed", s.seed},
      {"threads", s.threads},
      {"ending", s.ending},
      {"load_seconds", s.load_seconds},
      {"build_seconds", s.build_seconds},
      {"render_seconds", s.render_seconds},
      {"cpu_seconds", s.cpu_seconds},
      {"rays", s.rays},
      {"rays_per_second", s.render_seconds > 0 ? static_cast<double>(s.rays) / s.render_seconds : 0.0},
      {"samples_per_pixel", s.samples_per_pixel},
      {"noise", s.noise},
      {"estimator", s.estimator},
      {"invalid_samples", s.invalid_samples},
      {"peak_memory_bytes", peak_memory_bytes()},
  };
  const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
  if (path == "-")
    write_result(text);
  else
    write_whole_file(path, std::as_bytes(std::span(text)));
}

}  // namespace etendue
