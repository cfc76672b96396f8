#include "formats/mitsuba/writer/sky_pictures.h"

#include <cmath>

#include "math/vec.h"

namespace etendue::mitsuba {

Image upper_half_picture(const Spectrum& radiance) {
  constexpr int kWidth = 4, kHeight = 1024;
  Image picture(kWidth, kHeight);
  for (int y = 0; y < kHeight / 2; ++y)
    for (int x = 0; x < kWidth; ++x) picture.at(x, y) = radiance;
  return picture;
}

/// With 2n + 1 rows from pole to pole the odd ones lie where the n strips have their middles, the even ones between two
/// of them or at a pole.
Image mirrored_map(const Image& map) {
  const int width = map.width(), height = map.height();
  Image picture(width, 2 * height + 1);
  for (int y = 0; y < picture.height(); ++y) {
    const int above = std::max((y - 1) / 2, 0), below = std::min(y / 2, height - 1);
    for (int x = 0; x < width; ++x)
      picture.at(x, y) = 0.5f * (map.at(width - 1 - x, y % 2 == 0 ? above : below) + map.at(width - 1 - x, below));
  }
  return picture;
}

Image falloff_picture(float cutoff_deg, float exponent) {
  constexpr int kSide = 512;
  const float edge = std::tan(radians(cutoff_deg));
  const auto place = [&](int i) { return edge * (2 * (static_cast<float>(i) + 0.5f) / kSide - 1); };
  Image picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const float cosine = 1 / std::sqrt(1 + square(place(x)) + square(place(y)));
      picture.at(x, y) = Spectrum(std::pow(cosine, exponent));
    }
  return picture;
}

}  // namespace etendue::mitsuba
