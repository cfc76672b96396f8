#pragma once

#include <optional>
#include <vector>

#include "lights/light.h"
#include "testing/random.h"

/// Lights that several tests look at.
namespace etendue {

inline const Bounds3 kScene{{-1, -1, -1}, {1, 1, 1}};

inline MeshLight::Triangle triangle(const Point3& p0, const Point3& p1, const Point3& p2) {
  const Vec3 n = cross(p1 - p0, p2 - p0);
  return {p0, p1, p2, normalize(n), 0.5f * length(n)};
}

/// The faces of a cube with edge 1 about the origin, shining outwards.
inline std::vector<MeshLight::Triangle> cube() {
  std::vector<MeshLight::Triangle> faces;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {0.5f, -0.5f}) {
      const auto corner = [&](float a, float b) {
        Vec3 p(0);
        p[axis] = side;
        p[(axis + 1) % 3] = a;
        p[(axis + 2) % 3] = side > 0 ? b : -b;
        return p;
      };
      faces.push_back(triangle(corner(-0.5f, -0.5f), corner(0.5f, -0.5f), corner(0.5f, 0.5f)));
      faces.push_back(triangle(corner(-0.5f, -0.5f), corner(0.5f, 0.5f), corner(-0.5f, 0.5f)));
    }
  return faces;
}

/// A way to shine on `from`, from all of a light: `choice` picks the part.
inline std::optional<LightSample> sample_whole(const Light& light, const Point3& from, Vec2 u, float choice) {
  const PartChoice part = choose_part(light, choice);
  std::optional<LightSample> sample = sample_light(light, part.part, from, u);
  if (sample) sample->pdf *= part.probability;
  return sample;
}

/// Density with which sample_whole gives the direction to a point of the light.
inline float whole_pdf(const Light& light, const Point3& from, const LightHit& hit) {
  return light_pdf(light, from, hit) * part_probability(light, part_at(light, hit));
}

/// Noise with a bright texel.
inline EnvironmentLight environment(int width, int height, bool importance, MapOrientation orientation) {
  Random random(11);
  Image map(width, height);
  for (Spectrum& s : map.pixels()) s = Spectrum(square(random.value()));
  map.at(width / 3, height / 3) = Spectrum(5);
  TexelDistribution distribution(lookup_means(map, orientation.rows()));
  return {std::move(map), std::move(distribution), importance, 2, orientation};
}

}  // namespace etendue
