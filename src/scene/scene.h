#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/diagnostics.h"
#include "math/spectrum.h"
#include "math/transform.h"

/// What a scene file says, whatever its format: plain values, no behaviour. World space is y-up, right-handed, in metres;
/// angles whose names end in _deg are in degrees, all others in radians.
namespace etendue::scene {

/// Index into the SceneDescription's vector of T.
template <typename T>
struct Id {
  std::uint32_t index = 0;
  friend bool operator==(Id, Id) = default;
};

/// A picture used as a texture, with repeat wrapping and v pointing up (v = 0 is the bottom row).
struct Texture {
  std::string name;
  std::filesystem::path file;  ///< absolute or relative to the working folder
  SourceLocation where;
};

/// A colour or a texture.
using ColorInput = std::variant<Spectrum, Id<Texture>>;

struct DiffuseMaterial { ColorInput reflectance = Spectrum(0.5f); };       ///< Lambertian, both sides
struct MirrorMaterial { Spectrum reflectance{1}; };                         ///< perfect reflection, both sides
enum class Fresnel { exact, schlick };
struct GlassMaterial {                                                      ///< smooth dielectric boundary
  Spectrum reflectance{1}, transmittance{1};                                ///< tints of the two lobes
  float ior = 1.5f;                                                         ///< inside / outside; outside is the normal's side
  Fresnel fresnel = Fresnel::exact;
};
struct RefractionMaterial {                                                 ///< transmission only, no Fresnel reflection
  Spectrum transmittance{1};
  float ior = 1.5f;
};
enum class Microfacets { beckmann, ggx };
struct ConductorMaterial {                                                  ///< rough metal, both sides
  Spectrum eta, k;                                                          ///< complex index η + ik against the outside
  float alpha = 0.1f;                                                       ///< width of the distribution (Walter et al. 2007)
  Microfacets distribution = Microfacets::beckmann;
  Spectrum reflectance{1};                                                  ///< tint
};
struct NoReflection {};                                                     ///< reflects nothing (a pure emitter)
using Surface =
    std::variant<DiffuseMaterial, MirrorMaterial, GlassMaterial, RefractionMaterial, ConductorMaterial, NoReflection>;

struct Material {
  std::string name;
  Surface surface;
  Spectrum emission{0};  ///< radiance leaving the front (the side the normal points to), W·sr⁻¹·m⁻²
  SourceLocation where;
};

/// Indexed triangles; vertices carry position and, if the vectors are not empty, normal and texture coordinate.
struct Mesh {
  std::string name;
  std::vector<Point3> positions;
  std::vector<Vec3> normals;               ///< empty: flat; else as many as positions, unit
  std::vector<Vec2> uvs;                   ///< empty: none; else as many as positions
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from the front
  SourceLocation where;
};

/// Sphere about the local origin; instances scale it uniformly.
struct Sphere {
  std::string name;
  float radius = 1;
  SourceLocation where;
};

/// A shape placed in the world.
struct Instance {
  std::string name;
  std::variant<Id<Mesh>, Id<Sphere>> shape;
  Id<Material> material;
  Transform to_world;
  SourceLocation where;
};

/// Lights that are not part of a surface. All are placed by `to_world` and shine along their local −z where they have a direction.
struct PointLight { Spectrum intensity; };                   ///< radiant intensity, W·sr⁻¹
struct SpotLight {
  Spectrum intensity;                                         ///< on the axis
  float cutoff_deg = 45;                                      ///< half angle beyond which it is dark
  float falloff_exponent = 0;                                 ///< intensity · cos(angle)^exponent inside (COLLADA)
};
struct DirectionalLight { Spectrum irradiance; };            ///< on a surface facing it, W·m⁻²
struct RectangleLight { Spectrum radiance; };                ///< one-sided, edges ±½ along local x and y, front is −z
struct HemisphereLight { Spectrum radiance; };               ///< from every direction above the world's horizon
struct EnvironmentLight {                                     ///< latitude–longitude map, added by --env or a file
  std::filesystem::path file;
  float intensity = 1;
  float rotation_deg = 0;                                     ///< turns the map about +y, counter-clockwise seen from above
  bool mirrored = false;                                      ///< the CGL profile's mapping: reads right to left
};
using LightSource =
    std::variant<PointLight, SpotLight, DirectionalLight, RectangleLight, HemisphereLight, EnvironmentLight>;

struct Light {
  std::string name;
  LightSource source;
  Transform to_world;
  SourceLocation where;
};

/// A pinhole camera at its local origin, looking along −z with +y up.
struct Camera {
  std::string name;
  Transform to_world;
  float xfov_deg = 50;             ///< full horizontal angle for a picture of `aspect`
  float aspect = 4.0f / 3.0f;      ///< width / height that the file had in mind
  float near_clip = 0;             ///< distance along the axis before which nothing is seen
  float far_clip = 0;              ///< 0: none
  SourceLocation where;
};

struct SceneDescription {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Sphere> spheres;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<Camera> cameras;     ///< the first is the one to use

  std::filesystem::path file;
  std::string format;              ///< "COLLADA 1.4.1", …
  bool uses_cgl_profile = false;   ///< decides --camera-placement auto and the Fresnel default
};

}  // namespace etendue::scene
