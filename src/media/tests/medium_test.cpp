#include "media/medium.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "testing/quadrature.h"
#include "testing/random.h"
#include "testing/statistics.h"

namespace etendue {
namespace {

/// A grid of random values over the box from (−1, −1, −1) to (1, 2, 1), turned if asked for.
Volume noise(int size, int channels, float most, float angle, std::uint64_t seed) {
  Random random(seed);
  scene::GridVolume grid;
  grid.size = {size, size + 1, size + 2};
  grid.channels = channels;
  for (int i = 0; i < size * (size + 1) * (size + 2) * channels; ++i) grid.values.push_back(random.value() < 0.5f ? 0 : random.between(0, most));
  scene::Volume volume;
  volume.source = std::move(grid);
  volume.to_world = Transform::rotation({1, 2, 3}, angle) * Transform::translation({-1, -1, -1}) * Transform::scaling({2, 3, 2});
  return Volume(volume);
}

struct NamedMedium {
  std::string name;
  Medium medium;
};

std::vector<NamedMedium> media() {
  const Volume albedo(Spectrum(0.9f, 0.5f, 0.2f));
  return {{"grey", Medium(Volume(Spectrum(0.8f)), 1, albedo, IsotropicPhase{})},
          {"coloured", Medium(Volume(Spectrum(0.1f, 0.8f, 3)), 1.5f, albedo, IsotropicPhase{})},
          {"one channel empty", Medium(Volume(Spectrum(0, 0.8f, 3)), 1, albedo, IsotropicPhase{})},
          {"grid", Medium(noise(5, 1, 2, 0, 1), 1.5f, albedo, IsotropicPhase{})},
          {"coloured grid", Medium(noise(4, 3, 3, 0, 2), 1, noise(3, 3, 1, 0, 3), IsotropicPhase{})},
          {"turned grid", Medium(noise(20, 3, 4, 0.7f, 4), 1, albedo, IsotropicPhase{})}};
}

/// Through the grids' boxes, at an angle, along axes, and within.
const Ray kRays[] = {{{-3, 0.1f, 0.2f}, normalize(Vec3(1, 0.1f, -0.05f)), 0, 6},
                     {{0.3f, -4, 0.1f}, {0, 1, 0}, 1, 9},
                     {{0.3f, 0.4f, 0.1f}, normalize(Vec3(-1, 1, 1)), 0, 0.7f}};

/// Depth of the medium along the ray up to t, in the volume's own bounds.
double optical_depth(const Medium& medium, const Bounds3& bounds, const Ray& ray, double t, int channel) {
  const auto extinction = [&](double s) {
    const Point3 p = ray.at(static_cast<float>(s));
    for (int axis = 0; axis < 3; ++axis)
      if (!bounds.empty() && (p[axis] < bounds.min[axis] || p[axis] > bounds.max[axis])) return 0.0;
    return static_cast<double>(medium.extinction(p)[channel]);
  };
  double sum = 0;
  for (int i = 0; i < 64; ++i) {
    const double length = (t - ray.t_min) / 64;
    sum += integrate(extinction, ray.t_min + i * length, ray.t_min + (i + 1) * length, 1e-6);
  }
  return sum;
}

}  // namespace
}  // namespace etendue
