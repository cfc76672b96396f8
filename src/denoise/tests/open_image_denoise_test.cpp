// With a library on the run path that pretends to be Open Image Denoise.

#include "denoise/open_image_denoise.h"

#include <gtest/gtest.h>

#include "image/compare.h"
#include "synthetic_picture.h"

namespace etendue {
namespace {

TEST(OpenImageDenoise, IsFoundAndAsked) {
  const auto library = OpenImageDenoise::load();
  ASSERT_TRUE(library);
  const Image albedo(5, 4, Spectrum(0.25f, 0.5f, 0.75f));
  const auto result = library->filter(Image(5, 4, Spectrum(1)), albedo, Image(5, 4));
  ASSERT_TRUE(result);
  EXPECT_EQ(measure_error(*result, albedo).max_error, 0);
}

TEST(OpenImageDenoise, IsPreferred) {
  const auto color = [](int x, int y) { return Spectrum((x * 7 + y * 11) % 13 < 6 ? 0.2f : 0.7f); };
  const NoisyPicture picture = noisy_picture({color, color}, exponential_noise, 16);
  const Denoised denoised = denoise(picture);
  EXPECT_EQ(denoised.by, "Open Image Denoise");
  const double before = measure_error(mean_of(picture), image_of(color)).relative_mse;
  EXPECT_LT(measure_error(denoised.image, image_of(color)).relative_mse, 0.05 * before);
}

TEST(OpenImageDenoise, IsDoneWithoutWhereItFails) {
  PictureHalf half{Image(13, 9, Spectrum(1)), Image(13, 9), Image(13, 9), Image(13, 9), {}};
  half.depth.assign(13 * 9, 1);
  const Denoised denoised = denoise({{half, half}});
  EXPECT_EQ(denoised.by, "feature regression (NFOR)");
  EXPECT_LT(measure_error(denoised.image, half.color).max_error, 1e-6);
}

}  // namespace
}  // namespace etendue
