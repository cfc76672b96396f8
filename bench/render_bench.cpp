// Whole renders, measured as the documentation defines it (docs/performance.md):
//   rays/s               all rays traced, over the wall time of the passes, on 2 threads
//   trace bound          of plain paths: time for the same rays as single queries, over that of the render, 1 thread
//   inverse efficiency   CPU seconds × mean over pixels of variance / (mean² + 0.01), from independent seeds
// and reading and building a file of a million triangles. With the argument `trace-bound`, that alone.

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "camera/placement.h"
#include "formats/formats.h"
#include "million_triangles.h"
#include "render/scene_data.h"
#include "render/session.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// A scene with the camera that the benchmarks look through: 480 × 360, placed as `fit`.
struct Loaded {
  scene::SceneDescription description;
  RenderScene scene;
  Camera camera;
};

Loaded load(const fs::path& file, const fs::path& environment) {
  Diagnostics diagnostics;
  scene::SceneDescription description = read_scene(file, diagnostics);
  if (!environment.empty()) description.lights.push_back({"environment", scene::EnvironmentLight{environment}, {}, {}});
  RenderScene scene = compile(description, {.fresnel = scene::Fresnel::exact}, diagnostics);
  const Camera camera = place_camera(description, scene.bounds(), CameraPlacement::fit, 480, 360, diagnostics);
  return {std::move(description), std::move(scene), camera};
}

RenderSettings settings(int spp, int light_samples, int max_depth, std::uint64_t seed = 0) {
  RenderSettings s;
  s.width = 480;
  s.height = 360;
  s.samples_per_pixel = spp;
  s.light_samples = light_samples;
  s.max_depth = max_depth;
  s.seed = seed;
  return s;
}

struct Timing {
  double wall = 0, cpu = 0;
  std::uint64_t rays = 0;
  Image picture;
};

Timing render(const Loaded& loaded, const RenderSettings& s) {
  RenderSession session(loaded.scene, loaded.camera, s);
  const double cpu = cpu_seconds(), wall = wall_seconds();
  session.render_pass({}, s.samples_per_pixel);
  return {wall_seconds() - wall, cpu_seconds() - cpu, session.progress().rays, session.beauty()};
}

void report_throughput(const char* name, const Loaded& loaded, const RenderSettings& s) {
  std::vector<double> one, two, rate;
  for (int i = 0; i < 3; ++i) {
    {
      const ThreadLimit limit(2);
      const Timing t = render(loaded, s);
      two.push_back(t.wall);
      rate.push_back(static_cast<double>(t.rays) / t.wall * 1e-6);
    }
    const ThreadLimit limit(1);
    one.push_back(render(loaded, s).wall);
  }
  std::vector<double> ratios;
  for (std::size_t i = 0; i < one.size(); ++i) ratios.push_back(one[i] / two[i]);
  fmt::print("{:34} {:6.2f} M rays/s on 2 threads, {:.2f} s; 1 to 2 threads: {:.2f} times as fast\n", name,
             median(rate), median(two), median(ratios));
}

class Recorder : public RayRecorder {
 public:
  struct Recorded {
    Ray ray;
    bool occlusion;
  };
  void record(std::span<const Ray> rays, bool occlusion) override {
    for (const Ray& ray : rays) rays_.push_back({ray, occlusion});
  }
  const std::vector<Recorded>& rays() const { return rays_; }

 private:
  std::vector<Recorded> rays_;
};

void report_trace_bound(const char* name, const Loaded& loaded, RenderSettings s) {
  s.integrator = IntegratorKind::path;  // the techniques that `auto` adds do more than trace rays
  const ThreadLimit limit(1);
  s.crop = CropWindow{180, 120, 120, 120};  // the recorded rays have to fit into memory
  // The one writer of the scene while no one renders: the recorder is not part of what a scene is.
  auto& geometry = const_cast<Geometry&>(loaded.scene.data().geometry);
  Recorder recorder;
  geometry.set_recorder(&recorder);
  render(loaded, s);
  geometry.set_recorder(nullptr);
  std::vector<double> bounds, per_ray;
  const auto rays = static_cast<double>(recorder.rays().size());
  for (int i = 0; i < 5; ++i) {
    const double rendering = render(loaded, s).cpu;
    const double start = cpu_seconds();
    std::uint64_t sink = 0;
    for (const auto& [ray, occlusion] : recorder.rays())
      sink += occlusion ? geometry.occluded(std::span(&ray, 1)) : geometry.intersect(ray).primitive;
    const double tracing = cpu_seconds() - start;
    if (sink == 1) fmt::print("\n");  // the queries must not be optimised away
    bounds.push_back(tracing / rendering);
    per_ray.push_back(rendering / rays * 1e9);
  }
  fmt::print("{:34} trace bound {:.2f} ({:.1f} M rays, {:.0f} ns a ray in the render)\n", name, median(bounds),
             rays * 1e-6, median(per_ray));
}

void report_efficiency(const char* name, const Loaded& loaded, const RenderSettings& s) {
  const ThreadLimit limit(1);
  constexpr int kSeeds = 4;
  std::vector<Image> pictures;
  std::vector<double> cpu;
  for (int seed = 0; seed < kSeeds; ++seed) {
    RenderSettings seeded = s;
    seeded.seed = static_cast<std::uint64_t>(seed) + 1;
    Timing t = render(loaded, seeded);
    cpu.push_back(t.cpu);
    pictures.push_back(std::move(t.picture));
  }
  std::vector<double> relative;
  for (std::size_t p = 0; p < pictures[0].pixels().size(); ++p) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      double mean = 0, squares = 0;
      for (const Image& picture : pictures) mean += picture.pixels()[p][c] / kSeeds;
      for (const Image& picture : pictures)
        squares += (picture.pixels()[p][c] - mean) * (picture.pixels()[p][c] - mean);
      sum += squares / (kSeeds - 1) / (mean * mean + 0.01) / 3;
    }
    relative.push_back(sum);
  }
  std::sort(relative.begin(), relative.end());
  const auto mean_of = [&](std::size_t n) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += relative[i];
    return sum / static_cast<double>(n);
  };
  const double variance = mean_of(relative.size()), trimmed = mean_of(relative.size() * 999 / 1000);
  fmt::print(
      "{:34} inverse efficiency {:.3f} CPU s · relative variance ({:.3f} without the worst 0.1 %), {:.2f} CPU s\n",
      name, median(cpu) * variance, median(cpu) * trimmed, median(cpu));
}

/// In a process of its own, so that its peak memory is the reading's.
void report_million_triangles() {
  const fs::path file = fs::temp_directory_path() / fmt::format("etendue-million-{}.dae", getpid());
  constexpr int kSide = 708;
  write_sheet(file, kSide);
  std::fflush(stdout);
  if (const pid_t child = fork(); child == 0) {
    const double start = wall_seconds();
    Diagnostics diagnostics;
    const scene::SceneDescription description = read_scene(file, diagnostics);
    const double read = wall_seconds() - start;
    const RenderScene scene = compile(description, {}, diagnostics);
    const double total = wall_seconds() - start;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto triangles = static_cast<double>(scene.triangle_count());
    fmt::print("{:34} read in {:.2f} s, built in {:.2f} s; {:.0f} bytes a triangle at peak ({:.0f} MB file)\n",
               fmt::format("{:.0f} triangles", triangles), read, total - read,
               static_cast<double>(usage.ru_maxrss) * 1024 / triangles,
               static_cast<double>(fs::file_size(file)) * 1e-6);
    std::fflush(stdout);
    _exit(0);
  } else {
    waitpid(child, nullptr, 0);
  }
  fs::remove(file);
}

/// With `trace_bound_only`, nothing else is measured.
void run(bool trace_bound_only) {
  if (!trace_bound_only) report_million_triangles();
  const fs::path own = ETENDUE_SCENES;
  const auto whole = [&](const char* name, const Loaded& scene) {
    if (!trace_bound_only)
      report_throughput(fmt::format("{} -s 64 -l 4 -m 5", name).c_str(), scene, settings(64, 4, 5));
    report_trace_bound(fmt::format("{} -l 4 -m 5", name).c_str(), scene, settings(64, 4, 5));
    report_trace_bound(fmt::format("{} unlimited depth", name).c_str(), scene, settings(64, 0, kUnlimitedDepth));
    if (!trace_bound_only) report_efficiency(fmt::format("{} depth 100", name).c_str(), scene, settings(64, 0, 100));
  };
  whole("cornell-spheres", load(own / "cornell-spheres.dae", {}));
  report_trace_bound("knot", load(own / "knot.dae", {}), settings(64, 0, kUnlimitedDepth));
  const char* shared = std::getenv("ETENDUE_SHARED");
  if (shared == nullptr) {
    fmt::print("ETENDUE_SHARED is not set: the course's scenes are left out\n");
    return;
  }
  const fs::path course = fs::path(shared) / "scenes/cs184";
  whole("CBspheres", load(course / "CBspheres.dae", {}));
  report_trace_bound("CBbunny", load(course / "CBbunny.dae", {}), settings(64, 0, kUnlimitedDepth));
  report_trace_bound("bunny (copper, museum.exr)",
                     load(course / "bunny_microfacet_cu_unlit.dae", fs::path(shared) / "envmaps/museum.exr"),
                     settings(64, 0, kUnlimitedDepth));
}

}  // namespace
}  // namespace etendue

int main(int argc, char** argv) {
  const bool trace_bound_only = argc == 2 && std::string_view(argv[1]) == "trace-bound";
  if (argc > 1 && !trace_bound_only) {
    fmt::print(stderr, "usage: render_bench [trace-bound]\n");
    return 2;
  }
  try {
    etendue::run(trace_bound_only);
  } catch (const etendue::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
