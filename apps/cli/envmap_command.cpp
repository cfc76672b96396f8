#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/log.h"
#include "commands.h"
#include "file_names.h"
#include "image/io.h"
#include "lights/environment.h"
#include "terminal.h"

namespace etendue {
namespace {

double sin_theta(const Image& map, int row) {
  return std::sin(std::numbers::pi * (row + 0.5) / map.height());
}

/// Solid angle of a texel of this row, from its middle.
double texel_solid_angle(const Image& map, int row) {
  return 2 * std::numbers::pi * std::numbers::pi * sin_theta(map, row) / (double(map.width()) * map.height());
}

Vec2 texel_center(const Image& map, int x, int y) {
  return {(static_cast<float>(x) + 0.5f) / static_cast<float>(map.width()),
          (static_cast<float>(y) + 0.5f) / static_cast<float>(map.height())};
}

/// Sums of the map's light; per channel.
struct MapLight {
  std::array<double, 3> mean{};        ///< radiance, over the sphere
  std::array<double, 3> irradiance{};  ///< on a horizontal plane, from above
  float brightest = 0;                 ///< luminance
  Vec3 brightest_direction{0, 1, 0};
};

MapLight measure(const Image& map) {
  MapLight light;
  double sphere = 0;
  for (int y = 0; y < map.height(); ++y) {
    const double solid_angle = texel_solid_angle(map, y);
    const double cosine = std::cos(std::numbers::pi * (y + 0.5) / map.height());
    for (int x = 0; x < map.width(); ++x) {
      const Spectrum& radiance = map.at(x, y);
      for (int c = 0; c < 3; ++c) {
        light.mean[c] += radiance[c] * solid_angle;
        light.irradiance[c] += radiance[c] * solid_angle * std::max(cosine, 0.0);
      }
      sphere += solid_angle;
      if (radiance.luminance() > light.brightest) {
        light.brightest = radiance.luminance();
        light.brightest_direction = uv_to_direction({}, texel_center(map, x, y));
      }
    }
  }
  for (double& mean : light.mean) mean /= sphere;
  return light;
}

std::string describe(const Image& map, const MapRepairs& repairs) {
  const MapLight light = measure(map);
  std::string text;
  const auto row = [&](std::string_view name, const std::string& value) {
    text += fmt::format("{:<24}{}\n", name, value);
  };
  const auto triple = [](const auto& c) { return fmt::format("{:.6g} {:.6g} {:.6g}", c[0], c[1], c[2]); };
  row("size", fmt::format("{} x {}", map.width(), map.height()));
  row("repaired texels", fmt::format("{}", repairs.invalid));
  row("mean radiance", triple(light.mean));
  row("irradiance from above", triple(light.irradiance));
  if (light.brightest > 0) {
    const Vec3& d = light.brightest_direction;
    row("brightest direction",
        fmt::format("({:.4f}, {:.4f}, {:.4f}), {:.1f} degrees above the horizon, luminance {:.6g}", d.x, d.y, d.z,
                    degrees(std::asin(std::clamp(d.y, -1.0f, 1.0f))), light.brightest));
  }
  return text;
}

/// Red: the rows' cumulative probability; green: the columns' within their row. The bytes of the file are these values.
Image cumulative_picture(const TexelDistribution& distribution) {
  Image picture(distribution.width(), distribution.height());
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      picture.at(x, y) = {srgb_to_linear(distribution.row_cdf(y)), srgb_to_linear(distribution.column_cdf(y, x)), 0};
  return picture;
}

/// The density of sampled directions per steradian at the cells' middles: pdf_uv / (2π² sin θ).
Image density_picture(const TexelDistribution& distribution) {
  Image picture(distribution.width(), distribution.height());
  for (int y = 0; y < picture.height(); ++y) {
    const double jacobian = 2 * std::numbers::pi * std::numbers::pi * sin_theta(picture, y);
    for (int x = 0; x < picture.width(); ++x)
      picture.at(x, y) = Spectrum(static_cast<float>(distribution.pdf(texel_center(picture, x, y)) / jacobian));
  }
  return picture;
}

double integral(const Image& density) {
  double sum = 0;
  for (int y = 0; y < density.height(); ++y)
    for (int x = 0; x < density.width(); ++x) sum += density.at(x, y).r * texel_solid_angle(density, y);
  return sum;
}

std::vector<std::filesystem::path> written_files(const EnvmapOptions& options) {
  std::vector<std::filesystem::path> files;
  if (options.debug) files.push_back(*options.debug);
  if (options.pdf) files.push_back(*options.pdf);
  return files;
}

}  // namespace

int run(const EnvmapOptions& options) {
  check_distinct({options.file}, written_files(options));
  Image map = read_image(options.file);
  for (const std::filesystem::path& file : written_files(options)) check_writable(file, map.width(), map.height());
  const MapRepairs repairs = repair_map(map);
  if (repairs.invalid > 0)
    log_warning(fmt::format("warning: {}: texels that were no number, infinite or negative became black ({})",
                            options.file.string(), counted(repairs.invalid, "texel")));
  if (repairs.black)
    log_warning(fmt::format("warning: {} holds no light; renders leave it out", options.file.string()));

  std::string text = describe(map, repairs);
  if (options.debug) write_picture(*options.debug, {cumulative_picture(TexelDistribution(map)), {}, {}});
  if (options.pdf) {
    const Image density = density_picture(TexelDistribution(lookup_means(map, MapOrientation{}.rows())));
    write_picture(*options.pdf, {density, {}, {}});
    text += fmt::format("{:<24}{:.6f}\n", "integral of the density", integral(density));
  }
  write_result(text);
  return 0;
}

}  // namespace etendue
