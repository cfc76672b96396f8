#include <fmt/format.h>

#include "commands.h"
#include "file_names.h"
#include "image/compare.h"
#include "image/false_color.h"
#include "image/flip.h"
#include "image/io.h"
#include "terminal.h"

namespace etendue {
namespace {

constexpr int kAboveLimitExitCode = 5;

std::string error_table(const PictureError& e, double flip) {
  std::string text;
  const auto row = [&](std::string_view name, const std::string& value) {
    text += fmt::format("{:<24}{}\n", name, value);
  };
  row("mean of A", fmt::format("{:.6g}", e.mean));
  row("mean of B", fmt::format("{:.6g}", e.reference_mean));
  row("MSE", fmt::format("{:.6g}", e.mse));
  row("relative MSE", fmt::format("{:.6g}", e.relative_mse));
  row("PSNR", fmt::format("{:.2f} dB", e.psnr_db));
  row("FLIP", fmt::format("{:.4g}", flip));
  row("largest difference", fmt::format("{:.6g}", e.max_error));
  row("invalid pixels", fmt::format("{}", e.invalid_pixels));
  return text;
}

std::string welch_table(const WelchTest& t) {
  const Spectrum& s = t.mean_difference_sigmas;
  return fmt::format(
      "{:<24}{:.4f} % of {} pixel-channels (p > {:.3g})\n{:<24}{:.4f}\n{:<24}{:+.3f} {:+.3f} {:+.3f} sigma\n",
      "agreeing", 100 * t.agreeing_share, t.tested, t.alpha, "rms t", t.rms_t, "difference of means", s.r, s.g, s.b);
}

}  // namespace

int run(const DiffOptions& options) {
  if (options.heatmap) check_distinct({options.a, options.b}, {*options.heatmap});
  std::optional<WelchTest> welch;
  Image a, b;
  if (options.variance) {
    SampledPicture sampled_a = sampled_picture(read_picture(options.a));
    SampledPicture sampled_b = sampled_picture(read_picture(options.b));
    welch = welch_test(sampled_a, sampled_b);
    a = std::move(sampled_a.mean);
    b = std::move(sampled_b.mean);
  } else {
    a = read_image(options.a);
    b = read_image(options.b);
  }
  if (options.heatmap) check_writable(*options.heatmap, a.width(), a.height());
  const PictureError error = measure_error(a, b);
  const FlipError flip = flip_error(a, b);
  write_result(error_table(error, flip.mean) + (welch ? welch_table(*welch) : ""));
  if (options.heatmap) write_picture(*options.heatmap, {heat_map(flip.map, a.width(), a.height()), {}, {}});
  return options.fail_above && error.relative_mse > *options.fail_above ? kAboveLimitExitCode : 0;
}

}  // namespace etendue
