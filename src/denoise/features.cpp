#include "denoise/features.h"

#include <algorithm>

namespace etendue {
namespace {

constexpr Window kWindow{5, 1};
constexpr float kBandwidth = 1;

ColorPlanes planes_of(const Image& image) {
  return make_color_planes(image.width(), image.height(), [&](int c, int x, int y) { return image.at(x, y)[c]; });
}

float median_depth(const NoisyPicture& picture) {
  std::vector<float> depths;
  for (const PictureHalf& half : picture.halves)
    std::copy_if(half.depth.begin(), half.depth.end(), std::back_inserter(depths), [](float d) { return d > 0; });
  if (depths.empty()) return 1;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

/// As if it were a colour, in its first plane only.
ColorPlanes nearness(const PictureHalf& half, float unit) {
  const int width = half.color.width();
  return make_color_planes(width, half.color.height(), [&](int c, int x, int y) {
    const float depth = half.depth[static_cast<std::size_t>(y) * width + x];
    return c == 0 && depth > 0 ? 1 / (1 + depth / unit) : 0.0f;
  });
}

/// The mean of both halves, each filtered by the other's weights.
ColorPlanes filtered(const ColorPlanes& a, const ColorPlanes& b) {
  ColorPlanes variance = make_color_planes(a[0].width(), a[0].height(), [&](int c, int x, int y) {
    const float difference = a[c].row(y)[x] - b[c].row(y)[x];
    return 0.5f * difference * difference;
  });
  for (Plane& plane : variance) plane = box_blurred(plane, 1);
  const ColorPlanes of_a = weighted_mean(a, {b, variance}, kWindow, kBandwidth);
  const ColorPlanes of_b = weighted_mean(b, {a, variance}, kWindow, kBandwidth);
  return make_color_planes(a[0].width(), a[0].height(),
                           [&](int c, int x, int y) { return 0.5f * (of_a[c].row(y)[x] + of_b[c].row(y)[x]); });
}

}  // namespace

Features filtered_features(const NoisyPicture& picture) {
  const auto& [a, b] = picture.halves;
  const float unit = median_depth(picture);
  ColorPlanes albedo = filtered(planes_of(a.albedo), planes_of(b.albedo));
  ColorPlanes normal = filtered(planes_of(a.normal), planes_of(b.normal));
  ColorPlanes depth = filtered(nearness(a, unit), nearness(b, unit));
  return {std::move(albedo[0]), std::move(albedo[1]), std::move(albedo[2]), std::move(normal[0]),
          std::move(normal[1]), std::move(normal[2]), std::move(depth[0])};
}

}  // namespace etendue
