// The course's scenes against independent pictures of them, where ETENDUE_SHARED names the folder that has both.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "camera/placement.h"
#include "formats/formats.h"
#include "image/false_color.h"
#include "image/io.h"
#include "picture_statistics.h"
#include "scene_kit.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 480, kHeight = 360, kSamples = 64, kBlock = 8;

struct Reference {
  std::string name, scene;
  int samples = 0;  ///< of the reference
  int max_depth = kUnlimitedDepth;
  float lens_radius = 0, focal_distance = 1;
  bool environment = false;
};

std::ostream& operator<<(std::ostream& out, const Reference& reference) {
  return out << reference.name;
}

Picture rendered(const Reference& reference, const fs::path& shared) {
  Diagnostics diagnostics;
  scene::SceneDescription description = read_scene(shared / "scenes/cs184" / reference.scene, diagnostics);
  if (reference.environment)
    description.lights.push_back(
        {"environment", scene::EnvironmentLight{shared / "envmaps/museum.exr", 1, 0, false}, {}, {}});
  const RenderScene scene = compile(description, {scene::Fresnel::exact}, diagnostics);
  Camera camera = place_camera(description, scene.bounds(), CameraPlacement::fit, kWidth, kHeight, diagnostics);
  if (reference.lens_radius > 0) {
    camera.lens_radius = reference.lens_radius;
    camera.focal_distance = reference.focal_distance;
  }
  RenderSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.samples_per_pixel = kSamples;
  settings.max_depth = reference.max_depth;
  return render(scene, camera, settings);
}

/// Pictures for a person to look at, in the working folder; returns their names.
std::string write_artefacts(const std::string& name, const Picture& ours, const Image& reference,
                            const BlockComparison& comparison) {
  std::vector<float> error, doubt;
  for (std::size_t i = 0; i < reference.pixels().size(); ++i) {
    const Spectrum difference = ours.beauty.pixels()[i] - reference.pixels()[i];
    error.push_back(std::abs(difference.luminance()) / (reference.pixels()[i].luminance() + 0.01f));
  }
  for (const Spectrum& p : comparison.p_values.pixels())
    doubt.push_back(-std::log10(std::max(std::min({p.r, p.g, p.b}), 1e-10f)) / 10);
  const auto& blocks = comparison.p_values;
  write_picture(name + "_ours.exr", ours);
  write_picture(name + "_reference.exr", {reference, {}, {}});
  write_picture(name + "_error.png", {heat_map(error, kWidth, kHeight), {}, {}});
  write_picture(name + "_p.png", {heat_map(doubt, blocks.width(), blocks.height()), {}, {}});
  return fmt::format(
      "see {0}_ours.exr, {0}_reference.exr, {0}_error.png (relative) and {0}_p.png (-log10 p / 10) in {1}", name,
      fs::current_path().string());
}

class References : public ::testing::TestWithParam<Reference> {};

TEST_P(References, AgreeInBlocks) {
  const char* const shared = std::getenv("ETENDUE_SHARED");
  if (shared == nullptr) GTEST_SKIP() << "ETENDUE_SHARED is not set: the reference pictures are not here";
  const Reference& reference = GetParam();
  const fs::path stem = fs::path(shared) / "references" / reference.name;
  const Picture ours = rendered(reference, shared);

  SampledPicture theirs{read_image(stem.string() + "_ref_rgb.exr"), read_image(stem.string() + "_ref_rgb_var.exr"),
                        std::vector<float>(ours.beauty.pixels().size(), static_cast<float>(reference.samples))};
  // Both are judged by the reference's variance, which is the better known: lower variance of ours must not sharpen the
  // test.
  const SampledPicture sampled{ours.beauty, theirs.variance, sampled_picture(ours).samples};
  const BlockComparison comparison = compare_in_blocks(sampled, theirs, kBlock);
  fmt::print("{}: {:.2f} % of block-channels agree, root mean square z {:.2f}\n", reference.name,
             100 * comparison.agreeing_share, comparison.rms_z);
  EXPECT_GE(comparison.agreeing_share, kAgreeingShare)
      << write_artefacts(reference.name, ours, theirs.mean, comparison);
}

INSTANTIATE_TEST_SUITE_P(
    , References,
    ::testing::Values(Reference{.name = "CBspheres", .scene = "CBspheres.dae", .samples = 1024},
                      Reference{.name = "CBspheres_depth2", .scene = "CBspheres.dae", .samples = 512, .max_depth = 2},
                      Reference{.name = "CBspheres_lens",
                                .scene = "CBspheres.dae",
                                .samples = 768,
                                .lens_radius = 0.15f,
                                .focal_distance = 4.5f},
                      Reference{.name = "CBbunny", .scene = "CBbunny.dae", .samples = 384},
                      Reference{.name = "bunny_microfacet_cu_unlit",
                                .scene = "bunny_microfacet_cu_unlit.dae",
                                .samples = 384,
                                .environment = true}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace etendue
