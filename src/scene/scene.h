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

/// What a scene file says, whatever its format: plain values, no behaviour. World space is y-up, right-handed, in
/// metres; angles whose names end in _deg are in degrees, all others in radians.
namespace etendue::scene {

/// Index into the SceneDescription's vector of T.
template <typename T>
struct Id {
  std::uint32_t index = 0;
  friend bool operator==(Id, Id) = default;
};

struct Texture;
struct Material;
struct Volume;
struct Medium;
struct Mesh;
struct Sphere;
struct Disk;
struct Cylinder;
struct Curves;
struct Group;

/// A colour or a texture.
using ColorInput = std::variant<Spectrum, Id<Texture>>;
/// A number or a texture: the luminance of its colour.
using FloatInput = std::variant<float, Id<Texture>>;
/// A value that may vary in space: constant or a volume.
using VolumeInput = std::variant<Spectrum, Id<Volume>>;

/// ---- Textures ----------------------------------------------------------------------------------------------------

enum class TextureFilter { nearest, bilinear };
enum class TextureWrap { repeat, mirror, clamp };

/// A picture. Its bottom row lies at v = 0, v points up.
struct BitmapTexture {
  std::filesystem::path file;  ///< absolute or relative to the working folder
  TextureFilter filter = TextureFilter::bilinear;
  TextureWrap wrap = TextureWrap::repeat;
  bool raw = false;  ///< numbers as they stand in the file: neither decoded as sRGB nor brought into [0, 1]
};
/// Two by two fields to a unit square of texture coordinates; color0 where both coordinates' halves agree (as at the
/// origin).
struct CheckerboardTexture {
  ColorInput color0 = Spectrum(0.4f), color1 = Spectrum(0.2f);
};
/// A mesh's own attribute of that name, times `scale`; black with a warning where a mesh has none.
struct MeshAttributeTexture {
  std::string attribute;
  float scale = 1;
};
/// The volume's value at the point's place in the world.
struct VolumeTexture {
  Id<Volume> volume;
};

/// Affine map of texture coordinates: uv ↦ x·uv.x + y·uv.y + offset.
struct UvTransform {
  std::array<float, 2> x{1, 0}, y{0, 1}, offset{0, 0};
};

/// A value that varies over surfaces.
struct Texture {
  std::string name;
  std::variant<BitmapTexture, CheckerboardTexture, MeshAttributeTexture, VolumeTexture> source;
  UvTransform to_uv;  ///< applied to the surface's coordinates before the lookup; bitmaps and checkerboards only
  SourceLocation where;
};

/// ---- Materials ---------------------------------------------------------------------------------------------------

/// Lambertian.
struct DiffuseMaterial {
  ColorInput reflectance = Spectrum(0.5f);
};
/// Perfect reflection.
struct MirrorMaterial {
  Spectrum reflectance{1};
};
enum class Fresnel { exact, schlick };
struct GlassMaterial {                        ///< smooth dielectric boundary
  Spectrum reflectance{1}, transmittance{1};  ///< tints of the two lobes
  float ior = 1.5f;                           ///< inside / outside; outside is the normal's side
  Fresnel fresnel = Fresnel::exact;
};
struct ThinGlassMaterial {  ///< both boundaries of a pane at once: nothing is bent
  ColorInput reflectance = Spectrum(1), transmittance = Spectrum(1);
  float ior = 1.5f;
};
struct RefractionMaterial {  ///< transmission only, no Fresnel reflection
  Spectrum transmittance{1};
  float ior = 1.5f;
};
enum class Microfacets { beckmann, ggx };
struct RoughGlassMaterial {  ///< rough dielectric boundary (Walter et al. 2007)
  ColorInput reflectance = Spectrum(1), transmittance = Spectrum(1);
  float ior = 1.5f;                           ///< inside / outside
  FloatInput alpha_u = 0.1f, alpha_v = 0.1f;  ///< widths along the two tangents
  Microfacets distribution = Microfacets::ggx;
};
struct ConductorMaterial {                    ///< metal
  Spectrum eta, k;                            ///< complex index η + ik against the outside; η = 0: a perfect mirror
  FloatInput alpha_u = 0.1f, alpha_v = 0.1f;  ///< widths of the distribution (Walter et al. 2007); both 0: smooth
  Microfacets distribution = Microfacets::beckmann;
  ColorInput reflectance = Spectrum(1);  ///< tint
};
struct PlasticMaterial {                                        ///< diffuse base under a dielectric boundary
  ColorInput diffuse = Spectrum(0.5f), specular = Spectrum(1);  ///< base colour and tint of the boundary's reflection
  float ior = 1.49f;                                            ///< inside / outside
  bool nonlinear = false;  ///< colour shifts of light that is reflected inside again and again
  float alpha = 0;         ///< width of the boundary's microfacets; 0: smooth
  Microfacets distribution = Microfacets::beckmann;
};
/// Burley's "principled" material (2012, 2015) with Mitsuba's parameters; all in [0, 1] unless said otherwise.
struct PrincipledMaterial {
  ColorInput base_color = Spectrum(0.5f);
  FloatInput roughness = 0.5f, anisotropic = 0.0f, metallic = 0.0f, spec_trans = 0.0f, spec_tint = 0.0f, sheen = 0.0f,
             sheen_tint = 0.0f, flatness = 0.0f, clearcoat = 0.0f, clearcoat_gloss = 0.0f;
  float eta = 1.5f;  ///< inside / outside
  /// How often each lobe is sampled, relative to the others.
  float main_specular_rate = 1, clearcoat_rate = 1, diffuse_rate = 1;
};
/// The same for sheets without thickness.
struct PrincipledThinMaterial {
  ColorInput base_color = Spectrum(0.5f);
  FloatInput roughness = 0.5f, anisotropic = 0.0f, spec_trans = 0.0f, eta = 1.5f, spec_tint = 0.0f, sheen = 0.0f,
             sheen_tint = 0.0f, flatness = 0.0f;
  FloatInput diff_trans = 0.0f;  ///< in [0, 2]: 1 sends as much through as back
  float specular_reflection_rate = 1, specular_transmission_rate = 1, diffuse_rate = 1, diffuse_transmission_rate = 1;
};
struct NullMaterial {};  ///< no boundary at all: light passes straight on
struct NoReflection {};  ///< reflects nothing (a pure emitter)
/// `second` with probability weight, else `first`.
struct BlendMaterial {
  Id<Material> first, second;
  FloatInput weight = 0.5f;
};
/// `inner` where there is something, nothing else where not.
struct MaskMaterial {
  Id<Material> inner;
  FloatInput opacity = 0.5f;
};
/// Each side looks as the front of its material does.
struct TwoSidedMaterial {
  Id<Material> front, back;
};
/// What is done about shading normals that are tilted far.
struct TiltHandling {
  bool turn_back = true;     ///< those that would show the viewer the surface's other side are turned about the old one
  bool cast_shadows = true;  ///< the bumps darken light at grazing angles (Estevez, Lecocq and Stellios 2019)
};
/// Shading normals tilted by a height field: displacement along the normal is scale · luminance(height), in metres.
struct BumpMaterial {
  Id<Material> inner;
  Id<Texture> height;
  float scale = 1;
  TiltHandling handling = {};
};
/// Shading normals from a texture: colours 0…1 stand for −1…1 along ∂p/∂u, the third and the normal.
struct NormalMapMaterial {
  Id<Material> inner;
  Id<Texture> normals;
  TiltHandling handling = {};
};

using Surface =
    std::variant<DiffuseMaterial, MirrorMaterial, GlassMaterial, RefractionMaterial, ConductorMaterial, NoReflection,
                 ThinGlassMaterial, RoughGlassMaterial, PlasticMaterial, PrincipledMaterial, PrincipledThinMaterial,
                 NullMaterial, BlendMaterial, MaskMaterial, TwoSidedMaterial, BumpMaterial, NormalMapMaterial>;

struct Material {
  std::string name;
  Surface surface;
  ColorInput emission = Spectrum(0);  ///< radiance leaving the front (the side the normal points to), W·sr⁻¹·m⁻²
  SourceLocation where;
  bool one_sided = false;  ///< black seen from the back; for surfaces that let nothing through
};

/// Whether the material gives off light of its own, as far as its description tells.
inline bool emits(const Material& material) {
  const Spectrum* constant = std::get_if<Spectrum>(&material.emission);
  return constant == nullptr || !constant->is_black();
}

/// ---- Volumes and media -------------------------------------------------------------------------------------------

/// Values on a regular grid that fills the unit cube [0, 1]³ of the volume's own space, at cell centres.
struct GridVolume {
  std::array<int, 3> size{1, 1, 1};                ///< cells along x, y, z
  int channels = 1;                                ///< 1 (grey) or 3 (linear Rec. 709)
  std::vector<float> values;                       ///< channel fastest, then x, y, z
  TextureFilter filter = TextureFilter::bilinear;  ///< bilinear: trilinear
  TextureWrap wrap = TextureWrap::clamp;
};
/// One grid of an OpenVDB (.vdb) or NanoVDB (.nvdb) file, in its own index-to-world space.
struct VdbVolume {
  std::filesystem::path file;
  std::string grid;  ///< empty: the first
};

struct Volume {
  std::string name;
  std::variant<GridVolume, VdbVolume> source;
  Transform to_world;
  SourceLocation where;
};

struct IsotropicPhase {};
/// Mean cosine of the scattering angle, in (−1, 1); positive: forward.
struct HenyeyGreensteinPhase {
  float g = 0;
};
using Phase = std::variant<IsotropicPhase, HenyeyGreensteinPhase>;

/// A participating medium: what fills the inside or outside of surfaces.
struct Medium {
  std::string name;
  VolumeInput sigma_t = Spectrum(1);     ///< extinction, m⁻¹, times `scale`; constant: homogeneous
  VolumeInput albedo = Spectrum(0.75f);  ///< share of extinction that is scattering
  float scale = 1;
  Phase phase;
  SourceLocation where;
};

/// ---- Shapes ------------------------------------------------------------------------------------------------------

/// Values at a mesh's vertices or faces, for MeshAttributeTexture.
struct MeshAttribute {
  std::string name;
  bool per_face = false;      ///< else one a vertex
  int channels = 3;           ///< 1 or 3
  std::vector<float> values;  ///< channel fastest
};

/// Indexed triangles; vertices carry position and, if the vectors are not empty, normal and texture coordinate.
struct Mesh {
  std::string name;
  std::vector<Point3> positions;
  std::vector<Vec3> normals;                            ///< empty: flat; else as many as positions, unit
  std::vector<Vec2> uvs;                                ///< empty: none; else as many as positions
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from the front
  SourceLocation where;
  std::vector<MeshAttribute> attributes;
};

/// Sphere about the local origin; instances scale it uniformly. Its front is the outside; ∂p/∂u runs around local y.
struct Sphere {
  std::string name;
  float radius = 1;
  SourceLocation where;
};

/// The unit disk in the local xy plane, its front +z; instances may make it an ellipse. Texture coordinates: radius,
/// angle / 2π.
struct Disk {
  std::string name;
  SourceLocation where;
};

/// Open cylinder of radius 1 about local z, 0 ≤ z ≤ 1, its front the outside. Texture coordinates: angle / 2π, z.
struct Cylinder {
  std::string name;
  SourceLocation where;
};

/// Round curves: control points with radii, swept along linear segments or uniform cubic B-splines.
struct Curves {
  enum class Basis { linear, bspline };
  std::string name;
  Basis basis = Basis::bspline;
  std::vector<Point3> positions;  ///< of all curves, one after the other
  std::vector<float> radii;       ///< as many
  /// Index of each segment's first control point; it uses 2 (linear) or 4 (bspline) in a row.
  std::vector<std::uint32_t> segments;
  SourceLocation where;
};

/// A shape placed in the world (or in a group).
struct Instance {
  std::string name;
  std::variant<Id<Mesh>, Id<Sphere>, Id<Group>, Id<Disk>, Id<Cylinder>, Id<Curves>> shape;
  Id<Material> material;  ///< not looked at for groups
  Transform to_world;
  SourceLocation where;
  /// The front is where the back would be (analytic shapes; meshes say it by winding and normals).
  bool flip_normals = false;
  /// What fills the back's and the front's side, if the surface is a boundary between media.
  std::optional<Id<Medium>> interior = {}, exterior = {};
  bool separates_media = false;  ///< interior and exterior say something: a missing one is vacuum
};

/// Shapes that are placed together, as often as wanted, and kept in memory once. Emission inside groups is not
/// supported: it is left out with a warning.
struct Group {
  std::string name;
  std::vector<Instance> instances;  ///< may hold further groups, none of them itself
  SourceLocation where;
};

/// ---- Lights ------------------------------------------------------------------------------------------------------

/// Lights that are not part of a surface. All are placed by `to_world` and shine along their local −z where they have a
/// direction.
/// Radiant intensity, W·sr⁻¹.
struct PointLight {
  Spectrum intensity;
};
struct SpotLight {
  Spectrum intensity;          ///< on the axis
  float cutoff_deg = 45;       ///< half angle beyond which it is dark
  float falloff_exponent = 0;  ///< intensity · cos(angle)^exponent inside (COLLADA)
  /// Half angle up to which it is full, from there falling linearly with the angle to the cutoff.
  std::optional<float> beam_deg = {};
  /// Factor; the picture spans the cone of the cutoff, upright with +y, as seen from the light.
  std::optional<Id<Texture>> texture = {};
};
/// A slide projector: a pinhole camera run backwards.
struct ProjectorLight {
  /// On a plane at distance 1, facing it; upright with +y, as seen from the light.
  ColorInput irradiance = Spectrum(1);
  float scale = 1;
  float xfov_deg = 45;  ///< full horizontal angle
  float aspect = 1;     ///< width / height of the picture
};
/// On a surface facing it, W·m⁻².
struct DirectionalLight {
  Spectrum irradiance;
};
/// One-sided, edges ±½ along local x and y, front is −z.
struct RectangleLight {
  Spectrum radiance;
};
/// From every direction above the world's horizon.
struct HemisphereLight {
  Spectrum radiance;
};
/// From every direction.
struct ConstantLight {
  Spectrum radiance;
};
struct EnvironmentLight {  ///< latitude–longitude map, added by --env or a file
  std::filesystem::path file;
  float intensity = 1;
  float rotation_deg = 0;  ///< turns the map about +y, counter-clockwise seen from above
  bool mirrored = false;   ///< the CGL profile's mapping: reads right to left
};
/// The light's to_world also turns an EnvironmentLight, whose poles are its local ±y.
using LightSource = std::variant<PointLight, SpotLight, DirectionalLight, RectangleLight, HemisphereLight,
                                 EnvironmentLight, ProjectorLight, ConstantLight>;

struct Light {
  std::string name;
  LightSource source;
  Transform to_world;
  SourceLocation where;
};

/// ---- Cameras -----------------------------------------------------------------------------------------------------

enum class FilterKind { box, tent, gaussian, mitchell, catmull_rom, lanczos };

/// How samples near a pixel count towards it.
struct ReconstructionFilter {
  FilterKind kind = FilterKind::box;
  float radius = 0.5f;  ///< pixels; box ½, tent 1, gaussian 4σ, mitchell and catmull_rom 2, lanczos its lobes
  float b = 1.0f / 3, c = 1.0f / 3;  ///< mitchell's two parameters
};

/// The picture that the file has in mind.
struct Film {
  int width = 0, height = 0;               ///< pixels; 0: not said
  std::optional<std::array<int, 4>> crop;  ///< x, y, width, height
  std::optional<ReconstructionFilter> filter;
};

enum class Projection {
  perspective,
  orthographic,
  radiance,    ///< every pixel measures the radiance along the axis
  irradiance,  ///< every pixel measures the irradiance of `measured_shape`, W·m⁻²
};

/// A camera at its local origin, looking along −z with +y up.
struct Camera {
  std::string name;
  Transform to_world;          ///< orthographic: the picture spans ±1 along local x, which may be scaled
  float xfov_deg = 50;         ///< full horizontal angle for a picture of `aspect`
  float aspect = 4.0f / 3.0f;  ///< width / height that the file had in mind
  float near_clip = 0;         ///< distance along the axis before which nothing is seen
  float far_clip = 0;          ///< 0: none
  SourceLocation where;
  Projection projection = Projection::perspective;
  /// Offset of the picture's centre from the axis, in widths and heights, right and down.
  std::array<float, 2> principal_point{0, 0};
  bool mirrored = false;     ///< the picture is flipped left to right
  float lens_radius = 0;     ///< metres; 0: a pinhole
  float focal_distance = 0;  ///< along the axis to the sharp plane; 0: not said
  Film film;
  std::optional<Id<Medium>> medium;             ///< in which the camera stands
  std::optional<std::uint32_t> measured_shape;  ///< index into instances, for Projection::irradiance
};

/// What the file asks of a render; a user's flags come first.
struct RenderHints {
  std::optional<int> max_depth;  ///< bounces: 0 emitted light only, 1 direct light, …
  std::optional<int> samples_per_pixel;
  bool null_counts_as_bounce = false;  ///< whether passing a boundary that does nothing uses up one of max_depth
  bool hide_emitters = false;          ///< the camera sees neither lights nor their shapes directly
};

struct SceneDescription {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Sphere> spheres;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<Camera> cameras;  ///< the first is the one to use

  std::filesystem::path file;
  std::string format;             ///< "COLLADA 1.4.1", …
  bool uses_cgl_profile = false;  ///< decides --camera-placement auto and the Fresnel default

  std::vector<Disk> disks;
  std::vector<Cylinder> cylinders;
  std::vector<Curves> curves;
  std::vector<Group> groups;
  std::vector<Volume> volumes;
  std::vector<Medium> media;
  RenderHints hints;
};

}  // namespace etendue::scene
