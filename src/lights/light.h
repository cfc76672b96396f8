#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "image/image.h"
#include "lights/area_sampler.h"
#include "lights/environment.h"
#include "lights/light_bounds.h"
#include "lights/rectangle.h"
#include "materials/texture.h"
#include "math/bounds.h"
#include "math/frame.h"
#include "math/spectrum.h"
#include "math/transform.h"
#include "math/vec.h"
#include "sampling/distribution.h"

namespace etendue {

/// A direction from which a light shines on a point.
struct LightSample {
  Vec3 wi;                ///< unit, towards the light
  float distance = 0;     ///< to it; infinite for lights at infinity
  Spectrum radiance;      ///< arriving along wi if nothing is in between; for delta lights the irradiance on a surface
                          ///< facing wi, × pdf
  float pdf = 0;          ///< per solid angle at the lit point; 1 for delta lights
  bool is_delta = false;  ///< no BSDF sample can find this light
  Vec3 normal{0, 0, 0};   ///< of the light's surface, on the side that shines; zero for lights without one
  float error = 0;  ///< bound of the sampled point's rounding error: how far before the surface a shadow ray must end
};

/// A point on a light that a ray found: what its density depends on.
struct LightHit {
  Point3 position;
  Vec3 normal;                  ///< unit, on the side that shines
  std::uint32_t primitive = 0;  ///< triangle within the mesh
  float u = 0, v = 0;           ///< as in RayHit
};

/// What every light offers. `power`: emitted flux in W, roughly. Those that are not at infinity have bounds(), too, of
/// each part if there are any.
template <typename T>
concept LightModel = requires(const T& light, const Bounds3& scene) {
  { light.power(scene) } -> std::same_as<float>;
  { T::kDelta } -> std::convertible_to<bool>;
};

/// A light that is sampled as a whole, by u, uniform in [0,1)².
template <typename T>
concept WholeLight = LightModel<T> && requires(const T& light, const Point3& from, Vec2 u) {
  { light.sample(from, u) } -> std::same_as<std::optional<LightSample>>;
};

/// A light of many parts, which are chosen first: `parts` has their shares of the flux.
template <typename T>
concept LightOfParts = LightModel<T> &&
    requires(const T& light, std::uint32_t part, const Point3& from, Vec2 u, const LightHit& hit) {
  { light.sample(part, from, u) } -> std::same_as<std::optional<LightSample>>;
  { light.part_at(hit) } -> std::same_as<std::uint32_t>;
  { light.bounds(part) } -> std::same_as<LightBounds>;
  { light.parts } -> std::convertible_to<const DiscreteDistribution&>;
};

/// `pdf_hit`: density per solid angle, at `from`, of sample() giving the direction to `hit`, if the part there is the
/// chosen one.
template <typename T>
concept FiniteAreaLight = LightModel<T> && requires(const T& light, const Point3& from, const LightHit& hit) {
  { light.pdf_hit(from, hit) } -> std::same_as<float>;
};

/// What a ray into the void sees of a light at infinity, and the density per solid angle with which sample() gives its
/// direction.
struct InfiniteView {
  Spectrum radiance;
  float pdf = 0;
};

template <typename T>
concept InfiniteLight = WholeLight<T> && requires(const T& light, const Vec3& wi) {
  { light.look(wi) } -> std::same_as<InfiniteView>;
};

struct PointLight {
  static constexpr bool kDelta = true;
  Point3 position;
  Spectrum intensity;  ///< W·sr⁻¹

  std::optional<LightSample> sample(const Point3& from, Vec2 u) const;
  float power(const Bounds3& scene) const;
  LightBounds bounds() const;
};

/// Within the cone intensity · cos(angle to the axis)^exponent · a ramp that falls with the angle from 1 at the beam's
/// edge to 0 at the cone's · the picture, if any, that spans the cone.
struct SpotLight {
  static constexpr bool kDelta = true;
  Transform
      frame;  ///< orthonormal, at the light, which shines along −z; the picture is upright with +y, seen from there
  Spectrum intensity;
  float cutoff = 0;  ///< radians, half angle
  float beam = 0;    ///< radians, at most the cutoff
  float exponent = 0;
  ColorSource picture = Spectrum(1);
  const Textures* textures = nullptr;

  std::optional<LightSample> sample(const Point3& from, Vec2 u) const;
  float power(const Bounds3& scene) const;
  LightBounds bounds() const;
};

/// A pinhole camera run backwards: gives a plane at distance 1, facing it, the irradiance of its picture.
struct ProjectorLight {
  static constexpr bool kDelta = true;
  Transform frame;                       ///< as of a SpotLight
  float tan_half_x = 1, tan_half_y = 1;  ///< half the picture on that plane
  float scale = 1;
  ColorSource picture = Spectrum(1);
  const Textures* textures = nullptr;

  std::optional<LightSample> sample(const Point3& from, Vec2 u) const;
  float power(const Bounds3& scene) const;
  LightBounds bounds() const;
};

struct DirectionalLight {
  static constexpr bool kDelta = true;
  Vec3 to_light;        ///< unit
  Spectrum irradiance;  ///< on a surface facing it

  std::optional<LightSample> sample(const Point3& from, Vec2 u) const;
  float power(const Bounds3& scene) const;
};

/// Parallelogram with right angles that shines to its front, sampled by solid angle near it and by area far away.
struct RectangleLight {
  static constexpr bool kDelta = false;
  Rectangle rectangle;
  Spectrum emitted;

  std::optional<LightSample> sample(const Point3& from, Vec2 u) const;
  float pdf_hit(const Point3& from, const LightHit& hit) const;
  float power(const Bounds3& scene) const;
  LightBounds bounds() const;
};

/// Triangles of one radiance, its parts; a point on one is chosen by area or, near it, by solid angle (Arvo 1995).
struct MeshLight {
  static constexpr bool kDelta = false;
  struct Triangle {
    Point3 p0, p1, p2;
    Vec3 normal;  ///< unit, the side that shines
    float area;
  };
  std::vector<Triangle> triangles;
  DiscreteDistribution parts;  ///< by area
  Spectrum emitted;

  MeshLight(std::vector<Triangle> triangles, const Spectrum& emitted);
  std::optional<LightSample> sample(std::uint32_t part, const Point3& from, Vec2 u) const;
  std::uint32_t part_at(const LightHit& hit) const;
  float pdf_hit(const Point3& from, const LightHit& hit) const;
  float power(const Bounds3& scene) const;
  LightBounds bounds(std::uint32_t part) const;
};

/// Sphere that shines outwards, sampled within the cone it subtends.
struct SphereLight {
  static constexpr bool kDelta = false;
  Point3 center;
  float radius;
  Spectrum emitted;

  std::optional<LightSample> sample(const Point3& from, Vec2 u) const;
  float pdf_hit(const Point3& from, const LightHit& hit) const;
  float power(const Bounds3& scene) const;
  LightBounds bounds() const;
};

/// What a shape of the geometry gives off where that is not the same everywhere.
struct Glow {
  const Geometry* geometry;
  const Textures* textures;
  std::uint32_t shape;
  ColorSource radiance;

  /// Towards the front, at a hit of the shape.
  Spectrum at(const RayHit& hit, const SurfaceHit& surface) const;
};

/// A mesh with a textured radiance. Its triangles are divided into small ones, its parts; a point on them is chosen by
/// area.
struct TexturedMeshLight {
  static constexpr bool kDelta = false;
  Glow glow;
  int divisions = 1;           ///< of each edge
  DiscreteDistribution parts;  ///< by flux, none of them 0
  std::vector<float> areas;    ///< of the whole triangles
  float flux = 0;              ///< luminance

  explicit TexturedMeshLight(const Glow& glow);
  AreaPoint sample_area(Vec2 u, float choice) const;  ///< all over it
  float pdf_area(const LightHit& hit) const;          ///< of sample_area
  std::optional<LightSample> sample(std::uint32_t part, const Point3& from, Vec2 u) const;
  std::uint32_t part_at(const LightHit& hit) const;
  float pdf_hit(const Point3& from, const LightHit& hit) const;
  float power(const Bounds3& scene) const;
  LightBounds bounds(std::uint32_t part) const;

 private:
  AreaPoint point_on(std::uint32_t part, Vec2 weights) const;
  float part_area(std::uint32_t triangle) const;
};

/// Disk, cylinder or sphere, sampled by area: spheres that shine inwards or have a texture.
struct CurvedLight {
  static constexpr bool kDelta = false;
  Glow glow;
  float flux = 0;  ///< luminance

  explicit CurvedLight(const Glow& glow);
  float pdf_area(const LightHit& hit) const;  ///< of sample_curved
  std::optional<LightSample> sample(const Point3& from, Vec2 u) const;
  float pdf_hit(const Point3& from, const LightHit& hit) const;
  float power(const Bounds3& scene) const;
  LightBounds bounds() const;
};

/// Constant radiance from every direction, or from those with y ≥ 0.
struct UniformLight {
  static constexpr bool kDelta = false;
  Spectrum emitted;
  bool upper_half = false;

  std::optional<LightSample> sample(const Point3& from, Vec2 u) const;
  InfiniteView look(const Vec3& wi) const;
  float power(const Bounds3& scene) const;
};

/// Latitude–longitude map at infinity, with bilinear lookup; directions by its brightness or uniformly.
struct EnvironmentLight {
  static constexpr bool kDelta = false;
  Image map;
  TexelDistribution distribution;  ///< of the map's lookup_means
  bool importance = true;          ///< false: uniform on the sphere
  float intensity = 1;
  MapOrientation orientation;
  Frame axes = Frame::from_normal({0, 0, 1});  ///< world directions of the map's x, y and z
  bool turned = false;                         ///< the axes are not the world's

  std::optional<LightSample> sample(const Point3& from, Vec2 u) const;
  void sample(std::span<const Vec2> u, std::span<std::optional<LightSample>> samples) const;
  InfiniteView look(const Vec3& wi) const;
  void look(std::span<const Vec3> wi, std::span<InfiniteView> views) const;
  float power(const Bounds3& scene) const;

 private:
  Vec3 to_local(const Vec3& w) const { return turned ? axes.to_local(w) : w; }
  Vec3 to_world(const Vec3& w) const { return turned ? axes.to_world(w) : w; }
};

/// The one list of lights.
using Light = std::variant<PointLight, SpotLight, ProjectorLight, DirectionalLight, RectangleLight, MeshLight,
                           SphereLight, TexturedMeshLight, CurvedLight, UniformLight, EnvironmentLight>;

/// A light's part, and the probability of choosing it. Lights without parts are their own part 0.
struct PartChoice {
  std::uint32_t part = 0;
  float probability = 1;
};
std::uint32_t part_count(const Light& light);
/// By shares of the flux, from u uniform in [0,1).
PartChoice choose_part(const Light& light, float u);
/// That choose_part() chooses it.
float part_probability(const Light& light, std::uint32_t part);
std::uint32_t part_at(const Light& light, const LightHit& hit);

/// A way in which a part shines on `from`; its density knows nothing of the part's choice. Nothing if it cannot be seen
/// from there.
std::optional<LightSample> sample_light(const Light& light, std::uint32_t part, const Point3& from, Vec2 u);
/// The same for many points, at most 16: take(i, sample) for each that there is, from from[i] by part[i] and u[i].
/// Those of an environment wait for memory together.
template <typename Take>
void sample_light(const Light& light, std::span<const std::uint32_t> part, std::span<const Point3> from,
                  std::span<const Vec2> u, Take&& take) {
  if (const auto* environment = std::get_if<EnvironmentLight>(&light)) {
    std::optional<LightSample> samples[16];
    environment->sample(u, std::span(samples, u.size()));
    for (std::size_t i = 0; i < u.size(); ++i)
      if (samples[i]) take(i, *samples[i]);
  } else {
    for (std::size_t i = 0; i < u.size(); ++i)
      if (const auto sample = sample_light(light, part[i], from[i], u[i])) take(i, *sample);
  }
}
/// Density with which sample_light gives the direction to a point of a finite light, from the part that is there; 0 for
/// lights without surface.
float light_pdf(const Light& light, const Point3& from, const LightHit& hit);
/// Nothing for lights at infinity.
std::optional<LightBounds> light_bounds(const Light& light, std::uint32_t part);
/// What is seen of an infinite light along wi; black with density 0 for lights that are not at infinity.
InfiniteView look_at_infinity(const Light& light, const Vec3& wi);
/// The same along many directions, at most 16: they wait for memory together.
void look_at_infinity(const Light& light, std::span<const Vec3> wi, std::span<InfiniteView> views);
bool is_infinite(const Light& light);
bool is_delta(const Light& light);
/// Emitted flux in W, roughly.
float light_power(const Light& light, const Bounds3& scene);

}  // namespace etendue
