#include "denoise/denoise.h"

#include <algorithm>
#include <cmath>

#include "denoise/nfor.h"
#include "denoise/open_image_denoise.h"
#include "denoise/outliers.h"

namespace etendue {
namespace {

/// Little of a noisy picture shows much, where its brightest pixels are.
constexpr float kReluctanceToNoise = 0.25f;

ColorPlanes planes_of(const Image& image) {
  return make_color_planes(image.width(), image.height(), [&](int c, int x, int y) { return image.at(x, y)[c]; });
}

std::optional<Halves> by_open_image_denoise(const OpenImageDenoise& library, const NoisyPicture& picture) {
  std::array<Image, 2> filtered;
  for (int i = 0; i < 2; ++i) {
    const PictureHalf& half = picture.halves[i];
    const auto result = library.filter(half.color, half.albedo, half.normal);
    if (!result) return std::nullopt;
    filtered[i] = *result;
  }
  return Halves{planes_of(filtered[0]), planes_of(filtered[1])};
}

Halves noisy_halves(const NoisyPicture& picture) {
  return {planes_of(picture.halves[0].color), planes_of(picture.halves[1].color)};
}

/// The mean of both halves, mixed with the noisy picture, and that alone where it is not a number.
Image finished(const Halves& filtered, const Halves& noisy) {
  const Halves clean = without_outliers(noisy);
  const Halves mixed = best_mixture(filtered, clean, clean, kReluctanceToNoise);
  Image image(noisy.width(), noisy.height());
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        const float value = 0.5f * (mixed.a[c].row(y)[x] + mixed.b[c].row(y)[x]);
        const float fallback = 0.5f * (noisy.a[c].row(y)[x] + noisy.b[c].row(y)[x]);
        image.at(x, y)[c] = std::max(0.0f, std::isfinite(value) ? value : fallback);
      }
  return image;
}

}  // namespace

Denoised denoise(const NoisyPicture& picture) {
  if (const auto library = OpenImageDenoise::load())
    if (const auto filtered = by_open_image_denoise(*library, picture))
      return {finished(*filtered, noisy_halves(picture)), "Open Image Denoise"};
  return denoise_by_regression(picture);
}

Denoised denoise_by_regression(const NoisyPicture& picture) {
  const Halves noisy = noisy_halves(picture);
  return {finished(nfor(picture, without_outliers(noisy), noisy), noisy), "feature regression (NFOR)"};
}

}  // namespace etendue
