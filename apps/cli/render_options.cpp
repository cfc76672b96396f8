#include "render_options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <limits>

#include "base/error.h"
#include "flags.h"

namespace etendue {
namespace {

using flags::Range;

constexpr int kLargestSide = 65536;
constexpr std::int64_t kMostPixels = std::int64_t{1} << 30;
constexpr float kHuge = 1e30f;
constexpr float kLargestLength = 1e12f;  ///< metres; as far as geometry may reach

void add_scene(CLI::App& app, RenderFlags& f) {
  app.add_option("SCENE", f.options.scene, "The scene file");
  flags::definitions(app, f.options.read.definitions, "Give $NAME of a Mitsuba scene this value");
}

void add_output_flags(CLI::App& app, RenderFlags& f) {
  RenderOptions& o = f.options;
  app.add_option(
         "-o,-f,--output",
         [&o](const CLI::results_t& words) {
           o.outputs.assign(words.begin(), words.end());
           return true;
         },
         "Where the picture goes: .png .jpg .exr .hdr .tif; may be given several times")
      ->type_name("FILE")
      ->expected(1, CLI::detail::expected_max_vector_size)
      ->allow_extra_args(false)
      ->group("Output");
  flags::number(app, "--exposure", o.exposure_stops, Range{-100.0f, 100.0f}, "STOPS",
                "Brightens 8-bit pictures by this many stops (default 0)")
      ->group("Output");
  app.add_flag("--denoise", o.settings.for_denoising,
               "Take the noise out of the finished picture: by Open Image Denoise if the machine has it, else by "
               "regression on albedo, normal and depth. Biased; an .exr keeps the noisy picture as a layer too")
      ->group("Output");
  app.add_flag("--preview", o.preview, "Show the picture in the terminal while it renders")->group("Output");
  flags::file(app, "--stats", o.stats, "Write times, rays and memory as JSON (-: to standard output)")->group("Output");
}

void add_resolution_flag(CLI::App& app, RenderFlags& f) {
  RenderSettings& s = f.options.settings;
  RenderOptions::Given& given = f.options.given;
  flags::add(app, "-r,--resolution", {"W", "H"},
             "Width and height in pixels, also as WxH (default: the file's, or 800 600)",
             [&s, &given](auto words) {
               given.size = true;
               s.width = flags::parse_number("--resolution", words[0], Range{1, kLargestSide});
               s.height = flags::parse_number("--resolution", words[1], Range{1, kLargestSide});
             })
      ->group("Picture");
}

void add_picture_flags(CLI::App& app, RenderFlags& f) {
  RenderSettings& s = f.options.settings;
  RenderOptions::Given& given = f.options.given;
  flags::add(app, "-p,--crop", {"X", "Y", "W", "H"}, "Render only this part; X Y is its upper left pixel",
             [&s, &given](auto words) {
               given.crop = true;
               const auto at = [&](int i, int least) {
                 return flags::parse_number("--crop", words[i], Range{least, kLargestSide});
               };
               s.crop = CropWindow{at(0, 0), at(1, 0), at(2, 1), at(3, 1)};
             })
      ->group("Picture");
  flags::choice<IntegratorKind>(
      app, "--integrator", f.integrator,
      {{"auto", IntegratorKind::automatic},
       {"path", IntegratorKind::path},
       {"direct", IntegratorKind::direct},
       {"hemisphere", IntegratorKind::hemisphere},
       {"normals", IntegratorKind::normals},
       {"albedo", IntegratorKind::albedo},
       {"ao", IntegratorKind::ao}},
      "What to compute (default auto: all light, by what suits the scene; path: plain path tracing)")
      ->group("Picture");
  app.add_flag("-H,--hemisphere", f.hemisphere, "Direct light by uniform directions (= --integrator hemisphere)")
      ->group("Picture");
  flags::choice<scene::FilterKind>(app, "--filter", f.filter,
                                   {{"box", scene::FilterKind::box},
                                    {"tent", scene::FilterKind::tent},
                                    {"gaussian", scene::FilterKind::gaussian},
                                    {"mitchell", scene::FilterKind::mitchell},
                                    {"catmullrom", scene::FilterKind::catmull_rom},
                                    {"lanczos", scene::FilterKind::lanczos}},
                                   "How samples near a pixel count towards it (default: the file's, or box)")
      ->group("Picture");
  flags::choice<scene::Fresnel>(app, "--fresnel", f.options.compile.fresnel,
                                {{"exact", scene::Fresnel::exact}, {"schlick", scene::Fresnel::schlick}},
                                "Reflectance of glass, whatever the file says")
      ->group("Picture");
}

void add_sampling_flags(CLI::App& app, RenderFlags& f) {
  RenderOptions& o = f.options;
  RenderSettings& s = o.settings;
  flags::number(app, "-s,--spp", f.spp, Range{1, kMostSamplesPerPixel}, "N",
                "Samples a pixel (default: the file's, or 64; no limit with --time-limit or --noise)")
      ->group("Sampling");
  flags::number(app, "-l,--light-samples", s.light_samples, Range{0, 65536}, "N",
                "Samples of every light at every hit (default 0: of chosen lights, more where they matter more)")
      ->group("Sampling");
  flags::add(app, "-m,--max-depth", {"N|unlimited"},
             "Bounces: 0 emitted light only, 1 direct light (default: the file's, or unlimited)",
             [&o, &s](auto words) {
               o.given.depth = true;
               s.max_depth = words[0] == "unlimited"
                                 ? kUnlimitedDepth
                                 : flags::parse_number("--max-depth", words[0], Range{0, kUnlimitedDepth});
             })
      ->group("Sampling");
  flags::add(
      app, "-a,--adaptive", {"N", "TOL"},
      "Every N samples, stop pixels whose 95 % interval is within TOL of their mean (0.05 or 5%; 0: off, the default); "
      "also writes NAME_rate.png",
      [&f](auto words) {
        f.adaptive = AdaptiveSampling{flags::parse_number("--adaptive", words[0], Range{1, kMostSamplesPerPixel}),
                                      flags::parse_share("--adaptive", words[1], Range{0.0f, kHuge})};
      })
      ->group("Sampling");
  flags::choice<SamplerKind>(app, "--sampler", s.sampler,
                             {{"sobol", SamplerKind::sobol}, {"independent", SamplerKind::independent}},
                             "Where samples fall (default sobol)")
      ->group("Sampling");
  const std::vector<std::pair<std::string_view, Use>> uses{
      {"auto", Use::automatic}, {"on", Use::on}, {"off", Use::off}};
  flags::choice<Use>(app, "--photons", s.photons, uses, "Photons for light by way of mirrors and glass (default auto)")
      ->group("Sampling");
  flags::choice<Use>(app, "--reuse", s.reuse, uses, "Neighbouring pixels share their paths (default auto)")
      ->group("Sampling");
  flags::choice<Use>(app, "--cache", s.cache, uses, "Light between diffuse surfaces is looked up (default auto)")
      ->group("Sampling");
  flags::choice<Use>(app, "--airlight", s.airlight, uses,
                     "Rays through even fog gather light of lamps on their whole way (default auto)")
      ->group("Sampling");
  flags::choice<Use>(app, "--splitting", s.splitting, uses,
                     "Several lights asked at early vertices, both ways at glass, more rays by mirrors and glass alone "
                     "(default auto)")
      ->group("Sampling");
  flags::number(app, "--clamp", s.clamp, Range{1e-6f, kHuge}, "X",
                "No sample counts as brighter than this; biased (default: off)")
      ->group("Sampling");
  app.add_flag("--outliers", s.doubts_outliers,
               "Bright samples unlike all others around count for less; biased, the less the more samples")
      ->group("Sampling");
  flags::number(app, "--seed", s.seed, Range<std::uint64_t>{0, std::numeric_limits<std::uint64_t>::max()}, "N",
                "Another seed is another noise (default 0)")
      ->group("Sampling");
  flags::add(app, "--time-limit", {"TIME"}, "Stop rendering after 90s, 2m, 1h30m …", [&o](auto words) {
    o.time_limit_seconds = flags::parse_duration("--time-limit", words[0]);
  })->group("Sampling");
  flags::add(app, "--noise", {"X"}, "Stop when the estimated relative error is X, such as 0.02 or 2%",
             [&o](auto words) {
               o.noise_target = flags::parse_share("--noise", words[0], Range{1e-6, 1.0});
             })
      ->group("Sampling");
}

void add_environment_flags(CLI::App& app, RenderFlags& f) {
  flags::file(app, "-e,--env", f.env, "Light the scene with a latitude-longitude map as well")->group("Light");
  flags::number(app, "--env-intensity", f.env_intensity, Range{0.0f, kHuge}, "X", "Multiplies the map (default 1)")
      ->group("Light");
  flags::number(app, "--env-rotation", f.env_rotation_deg, Range{-kHuge, kHuge}, "DEG",
                "Turns the map, counter-clockwise seen from above (default 0)")
      ->group("Light");
  flags::choice<bool>(app, "--env-mapping", f.env_mirrored, {{"standard", false}, {"cgl", true}},
                      "cgl: mirrored, as the teaching renderer shows it")
      ->group("Light");
}

void add_light_flags(CLI::App& app, RenderFlags& f) {
  flags::choice<EnvironmentSampling>(
      app, "--env-sampling", f.options.compile.environment_sampling,
      {{"importance", EnvironmentSampling::importance}, {"uniform", EnvironmentSampling::uniform}},
      "How directions of the map are chosen (default importance)")
      ->group("Light");
  flags::choice<bool>(app, "--light-tree", f.options.compile.light_tree, {{"on", true}, {"off", false}},
                      "Choose lights by what they may give to a place (default on; off: by power alone)")
      ->group("Light");
  app.add_flag("--headlight", f.options.headlight, "Add a light at the camera, for scenes without lights")
      ->group("Light");
}

void add_placement_flag(CLI::App& app, RenderFlags& f) {
  flags::choice<CameraPlacement>(
      app, "--camera-placement", f.placement,
      {{"auto", CameraPlacement::automatic}, {"file", CameraPlacement::file}, {"fit", CameraPlacement::fit}},
      "file: the file's camera; fit: the teaching renderer's, aimed at the scene's box "
      "(default auto: fit for files with the CGL profile)")
      ->group("Camera");
}

void add_camera_flags(CLI::App& app, RenderFlags& f) {
  RenderOptions& o = f.options;
  flags::file(app, "-c,--camera", o.camera_file, "Camera settings, as --save-camera writes them")->group("Camera");
  flags::file(app, "--save-camera", o.save_camera, "Write the camera's settings")->group("Camera");
  flags::number(app, "-b,--lens-radius", o.lens_radius, Range{0.0f, kLargestLength}, "R",
                "Of a thin lens, in metres (default 0: a pinhole)")
      ->group("Camera");
  flags::number(app, "-d,--focal-distance", o.focal_distance, Range{1e-6f, kLargestLength}, "D",
                "To what is sharp, in metres (default: to the scene's centre)")
      ->group("Camera");
  flags::add(app, "--focus-at", {"X,Y"}, "Make what this pixel shows sharp", [&o](auto words) {
    const std::size_t comma = words[0].find(',');
    if (comma == std::string::npos)
      throw Error(Failure::usage, fmt::format("--focus-at needs a pixel such as 400,300, not \"{}\"", words[0]));
    const Range<int> range{0, kLargestSide - 1};
    o.focus_at = Pixel{flags::parse_number("--focus-at", words[0].substr(0, comma), range),
                       flags::parse_number("--focus-at", words[0].substr(comma + 1), range)};
  })->group("Camera");
  flags::number(app, "--blades", o.blades, Range{0, 64}, "N", "Sides of the aperture (default 0: round)")
      ->group("Camera");
  flags::number(app, "--blade-rotation", o.blade_rotation_deg, Range{-kHuge, kHuge}, "DEG", "Turns the aperture")
      ->group("Camera");
}

void add_machine_flags(CLI::App& app, RenderFlags& f) {
  flags::number(app, "-t,--threads", f.options.threads, Range{0, 4096}, "N", "Threads (default 0: all)")
      ->group("Machine");
  flags::number(app, "--tile-size", f.options.settings.tile_size, Range{1, 4096}, "N",
                "Pixels along the side of a unit of work; changes no pixel (default 16)")
      ->group("Machine");
  flags::add(
      app, "--memory-limit", {"SIZE"},
      "For photons and light to be looked up, such as 2G; fewer are made where more would not fit (default 512M)",
      [&s = f.options.settings](auto words) { s.memory_limit = flags::parse_memory("--memory-limit", words[0]); })
      ->group("Machine");
}

[[noreturn]] void fail(const std::string& message) {
  throw Error(Failure::usage, message);
}

/// A render that cannot fit into the machine's memory would be killed half-way.
void check_memory(const RenderSettings& s, const CropWindow& part) {
  constexpr double kBytesPerPixel = 250;  // film, picture with all its channels, encoded file
  constexpr double kBytesToDenoise = 700, kBytesForOutliers = 192;
  const double needed =
      (kBytesPerPixel + (s.for_denoising ? kBytesToDenoise : 0) + (s.doubts_outliers ? kBytesForOutliers : 0)) *
      part.width * part.height;
  const double memory = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  if (needed > memory)
    fail(
        fmt::format("a picture of {} x {} pixels needs about {:.0f} GB of memory, this machine has {:.0f} GB; choose a "
                    "smaller --resolution or render it in parts with --crop",
                    s.width, s.height, needed / 1e9, memory / 1e9));
}

void check_size(const RenderSettings& s) {
  if (std::int64_t{s.width} * s.height > kMostPixels)
    fail(fmt::format("--resolution {} {} is too large: a picture has at most {} pixels", s.width, s.height,
                     kMostPixels));
  const CropWindow c = s.crop.value_or(CropWindow{0, 0, s.width, s.height});
  if (c.x + c.width > s.width || c.y + c.height > s.height)
    fail(fmt::format("--crop {} {} {} {} reaches outside the picture of {} x {} pixels", c.x, c.y, c.width, c.height,
                     s.width, s.height));
  check_memory(s, c);
}

void check_camera(const RenderFlags& f) {
  const RenderOptions& o = f.options;
  if (o.blades == 1 || o.blades == 2) fail("--blades needs 3 or more (0: a round aperture)");
  if (o.focus_at && o.focal_distance) fail("--focus-at and --focal-distance both say what is sharp; give one of them");
  if (o.camera_file && f.placement) fail("--camera and --camera-placement both place the camera; give one of them");
}

scene::ReconstructionFilter standard_filter(scene::FilterKind kind) {
  switch (kind) {
    case scene::FilterKind::box:
      return {kind, 0.5f};
    case scene::FilterKind::tent:
      return {kind, 1};
    case scene::FilterKind::lanczos:
      return {kind, 3};
    case scene::FilterKind::gaussian:
    case scene::FilterKind::mitchell:
    case scene::FilterKind::catmull_rom:
      break;
  }
  return {kind, 2};
}

std::optional<scene::EnvironmentLight> environment_of(const RenderFlags& f) {
  if (f.env)
    return scene::EnvironmentLight{*f.env, f.env_intensity.value_or(1), f.env_rotation_deg.value_or(0),
                                   f.env_mirrored.value_or(false)};
  const char* const orphan = f.env_intensity      ? "--env-intensity"
                             : f.env_rotation_deg ? "--env-rotation"
                             : f.env_mirrored     ? "--env-mapping"
                                                  : nullptr;
  if (orphan) fail(fmt::format("{} needs a map: give --env FILE too", orphan));
  return std::nullopt;
}

}  // namespace

void add_convert_flags(CLI::App& app, RenderFlags& f) {
  add_scene(app, f);
  add_resolution_flag(app, f);
  add_environment_flags(app, f);
  add_placement_flag(app, f);
}

void add_render_flags(CLI::App& app, RenderFlags& f) {
  add_scene(app, f);
  add_output_flags(app, f);
  add_resolution_flag(app, f);
  add_picture_flags(app, f);
  add_sampling_flags(app, f);
  add_environment_flags(app, f);
  add_light_flags(app, f);
  add_placement_flag(app, f);
  add_camera_flags(app, f);
  add_machine_flags(app, f);
}

void check_picture(const RenderOptions& o) {
  check_size(o.settings);
  if (o.focus_at && (o.focus_at->x >= o.settings.width || o.focus_at->y >= o.settings.height))
    fail(fmt::format("--focus-at {},{} lies outside the picture of {} x {} pixels", o.focus_at->x, o.focus_at->y,
                     o.settings.width, o.settings.height));
}

RenderOptions settled(const RenderFlags& f) {
  RenderOptions o = f.options;
  if (o.scene.empty()) fail("render needs a scene: etendue render SCENE -o FILE");
  if (o.outputs.empty() && !o.preview) fail("render needs a place for the picture: add -o FILE.png (or .exr)");
  check_camera(f);
  if (f.hemisphere && f.integrator) fail("--hemisphere and --integrator both say what to compute; give one of them");
  if (o.settings.doubts_outliers && o.settings.for_denoising)
    fail("--outliers and --denoise both deal with bright dots; give one of them");
  o.settings.integrator = f.hemisphere ? IntegratorKind::hemisphere : f.integrator.value_or(IntegratorKind::automatic);
  if (f.adaptive && f.adaptive->tolerance > 0) o.settings.adaptive = f.adaptive;
  const bool ends_otherwise = o.time_limit_seconds || o.noise_target;
  o.settings.samples_per_pixel = f.spp.value_or(ends_otherwise ? kMostSamplesPerPixel : o.settings.samples_per_pixel);
  o.given.samples = f.spp || ends_otherwise;
  o.given.filter = f.filter.has_value();
  if (f.filter) o.settings.filter = standard_filter(*f.filter);
  if (o.given.size) check_picture(o);
  o.environment = environment_of(f);
  o.placement = f.placement.value_or(CameraPlacement::automatic);
  return o;
}

}  // namespace etendue
