#include "formats/mitsuba/writer/tests/scene_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace etendue::mitsuba::test {
namespace {

class SceneText {
 public:
  explicit SceneText(const scene::SceneDescription& scene) : scene_(scene) {}

  std::string run() const {
    std::string text = fields(scene_.hints.max_depth, scene_.hints.samples_per_pixel,
                              scene_.hints.null_counts_as_bounce, scene_.hints.hide_emitters) +
                       "\n";
    for (const scene::Camera& camera : scene_.cameras) text += "camera " + one(camera) + "\n";
    for (const scene::Light& light : scene_.lights)
      text += fmt::format("light {} {}\n", any(light.source), one(light.to_world));
    for (const scene::Instance& instance : scene_.instances) text += "instance " + one(instance) + "\n";
    return text;
  }

 private:
  template <typename... T>
  std::string fields(const T&... values) const {
    std::string text = "( ";
    ((text += one(values) + ' '), ...);
    return text + ")";
  }
  template <typename Variant>
  std::string any(const Variant& variant) const {
    return std::visit([&](const auto& value) { return fmt::format("{}: {}", variant.index(), one(value)); }, variant);
  }

  std::string one(bool b) const { return b ? "true" : "false"; }
  std::string one(int i) const { return fmt::format("{}", i); }
  std::string one(std::uint32_t i) const { return fmt::format("{}", i); }
  std::string one(float x) const { return fmt::format("{}", x + 0.0f); }
  std::string one(const std::string& s) const { return '"' + s + '"'; }
  std::string one(const Vec2& v) const { return fields(v.x, v.y); }
  std::string one(const Vec3& v) const { return fields(v.x, v.y, v.z); }
  std::string one(const Spectrum& s) const { return fields(s.r, s.g, s.b); }
  std::string one(const Transform& t) const { return fields(t.x, t.y, t.z, t.origin); }
  std::string one(const std::filesystem::path& p) const { return std::filesystem::weakly_canonical(p).string(); }
  template <typename T>
  requires std::is_enum_v<T> std::string one(T value)
  const { return fmt::format("{}", static_cast<int>(value)); }
  template <typename T, std::size_t n>
  std::string one(const std::array<T, n>& all) const {
    std::string text = "[ ";
    for (const T& value : all) text += one(value) + ' ';
    return text + "]";
  }
  template <typename T>
  std::string one(const std::vector<T>& all) const {
    std::string text = fmt::format("{} [ ", all.size());
    for (const T& value : all) text += one(value) + ' ';
    return text + "]";
  }
  template <typename T>
  std::string one(const std::optional<T>& value) const {
    return value ? one(*value) : "none";
  }
  template <typename... T>
  std::string one(const std::variant<T...>& variant) const {
    return any(variant);
  }

  std::string one(scene::Id<scene::Texture> id) const {
    const scene::Texture& t = scene_.textures.at(id.index);
    return "texture " + fields(t.source, t.to_uv);
  }
  std::string one(const scene::UvTransform& t) const { return fields(t.x, t.y, t.offset); }
  std::string one(const scene::BitmapTexture& t) const { return fields(t.file, t.filter, t.wrap, t.raw); }
  std::string one(const scene::CheckerboardTexture& t) const { return fields(t.color0, t.color1); }
  std::string one(const scene::MeshAttributeTexture& t) const { return fields(t.attribute, t.scale); }
  std::string one(const scene::VolumeTexture& t) const { return fields(t.volume); }

  std::string one(scene::Id<scene::Material> id) const {
    const scene::Material& m = scene_.materials.at(id.index);
    return "material " + fields(m.surface, m.emission, m.one_sided);
  }
  std::string one(const scene::DiffuseMaterial& m) const { return fields(m.reflectance); }
  std::string one(const scene::MirrorMaterial& m) const { return fields(m.reflectance); }
  std::string one(const scene::GlassMaterial& m) const {
    return fields(m.reflectance, m.transmittance, m.ior, m.fresnel);
  }
  std::string one(const scene::RefractionMaterial& m) const { return fields(m.transmittance, m.ior); }
  std::string one(const scene::ConductorMaterial& m) const {
    return fields(m.eta, m.k, m.alpha_u, m.alpha_v, m.distribution, m.reflectance);
  }
  std::string one(const scene::NoReflection&) const { return {}; }
  std::string one(const scene::ThinGlassMaterial& m) const { return fields(m.reflectance, m.transmittance, m.ior); }
  std::string one(const scene::RoughGlassMaterial& m) const {
    return fields(m.reflectance, m.transmittance, m.ior, m.alpha_u, m.alpha_v, m.distribution);
  }
  std::string one(const scene::PlasticMaterial& m) const {
    return fields(m.diffuse, m.specular, m.ior, m.nonlinear, m.alpha, m.distribution);
  }
  std::string one(const scene::PrincipledMaterial& m) const {
    return fields(m.base_color, m.roughness, m.anisotropic, m.metallic, m.spec_trans, m.spec_tint, m.sheen,
                  m.sheen_tint, m.flatness, m.clearcoat, m.clearcoat_gloss, m.eta, m.main_specular_rate,
                  m.clearcoat_rate, m.diffuse_rate);
  }
  std::string one(const scene::PrincipledThinMaterial& m) const {
    return fields(m.base_color, m.roughness, m.anisotropic, m.spec_trans, m.eta, m.spec_tint, m.sheen, m.sheen_tint,
                  m.flatness, m.diff_trans, m.specular_reflection_rate, m.specular_transmission_rate, m.diffuse_rate,
                  m.diffuse_transmission_rate);
  }
  std::string one(const scene::NullMaterial&) const { return {}; }
  std::string one(const scene::BlendMaterial& m) const { return fields(m.first, m.second, m.weight); }
  std::string one(const scene::MaskMaterial& m) const { return fields(m.inner, m.opacity); }
  std::string one(const scene::TwoSidedMaterial& m) const { return fields(m.front, m.back); }
  std::string one(const scene::BumpMaterial& m) const {
    return fields(m.inner, m.height, m.scale, m.handling.turn_back, m.handling.cast_shadows);
  }
  std::string one(const scene::NormalMapMaterial& m) const {
    return fields(m.inner, m.normals, m.handling.turn_back, m.handling.cast_shadows);
  }

  std::string one(scene::Id<scene::Volume> id) const {
    const scene::Volume& v = scene_.volumes.at(id.index);
    return "volume " + fields(v.source, v.to_world);
  }
  std::string one(const scene::GridVolume& v) const { return fields(v.size, v.channels, v.values, v.filter, v.wrap); }
  std::string one(const scene::VdbVolume& v) const { return fields(v.file, v.grid); }
  std::string one(scene::Id<scene::Medium> id) const {
    const scene::Medium& m = scene_.media.at(id.index);
    return "medium " + fields(m.sigma_t, m.albedo, m.scale, m.phase);
  }
  std::string one(const scene::IsotropicPhase&) const { return {}; }
  std::string one(const scene::HenyeyGreensteinPhase& p) const { return fields(p.g); }

  std::string one(const scene::MeshAttribute& a) const { return fields(a.name, a.per_face, a.channels, a.values); }
  std::string one(scene::Id<scene::Mesh> id) const {
    const scene::Mesh& m = scene_.meshes.at(id.index);
    return "mesh " + fields(m.positions, m.normals, m.uvs, m.triangles, m.attributes);
  }
  std::string one(scene::Id<scene::Sphere> id) const { return "sphere " + one(scene_.spheres.at(id.index).radius); }
  std::string one(scene::Id<scene::Disk>) const { return "disk"; }
  std::string one(scene::Id<scene::Cylinder>) const { return "cylinder"; }
  std::string one(scene::Id<scene::Curves> id) const {
    const scene::Curves& c = scene_.curves.at(id.index);
    return "curves " + fields(c.basis, c.positions, c.radii, c.segments);
  }
  std::string one(scene::Id<scene::Group> id) const { return "group " + one(scene_.groups.at(id.index).instances); }
  std::string one(const scene::Instance& i) const {
    const bool is_group = std::holds_alternative<scene::Id<scene::Group>>(i.shape);
    return fields(i.shape, i.to_world, i.flip_normals, i.interior, i.exterior, i.separates_media) +
           (is_group ? "" : one(i.material));
  }

  std::string one(const scene::PointLight& l) const { return fields(l.intensity); }
  std::string one(const scene::SpotLight& l) const {
    return fields(l.intensity, l.cutoff_deg, l.falloff_exponent, l.beam_deg, l.texture);
  }
  std::string one(const scene::ProjectorLight& l) const { return fields(l.irradiance, l.scale, l.xfov_deg, l.aspect); }
  std::string one(const scene::DirectionalLight& l) const { return fields(l.irradiance); }
  std::string one(const scene::RectangleLight& l) const { return fields(l.radiance); }
  std::string one(const scene::HemisphereLight& l) const { return fields(l.radiance); }
  std::string one(const scene::ConstantLight& l) const { return fields(l.radiance); }
  std::string one(const scene::EnvironmentLight& l) const {
    return fields(l.file, l.intensity, l.rotation_deg, l.mirrored);
  }

  std::string one(const scene::ReconstructionFilter& f) const { return fields(f.kind, f.radius, f.b, f.c); }
  std::string one(const scene::Film& f) const { return fields(f.width, f.height, f.crop, f.filter); }
  std::string one(const scene::Camera& c) const {
    return fields(c.to_world, c.xfov_deg, c.aspect, c.near_clip, c.far_clip, c.projection, c.principal_point,
                  c.mirrored, c.lens_radius, c.focal_distance, c.film, c.medium, c.measured_shape);
  }

  const scene::SceneDescription& scene_;
};

bool is_same(const std::string& a, const std::string& b) {
  if (a == b) return true;
  char *end_a = nullptr, *end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a), y = std::strtod(b.c_str(), &end_b);
  return *end_a == 0 && *end_b == 0 && std::abs(x - y) <= 1e-6 * std::max(std::abs(x), 0.1);
}

}  // namespace

std::string first_difference(const std::string& a, const std::string& b) {
  std::istringstream left(a), right(b);
  std::string before, x, y;
  while (true) {
    const bool has_x = static_cast<bool>(left >> x), has_y = static_cast<bool>(right >> y);
    if (!has_x && !has_y) return {};
    if (has_x != has_y || !is_same(x, y))
      return fmt::format("… {}: {} is not {}", before, has_x ? x : "nothing", has_y ? y : "nothing");
    before = (before.size() > 60 ? before.substr(before.size() - 60) : before) + " " + x;
  }
}

std::string text_of(const scene::SceneDescription& scene) {
  return SceneText(scene).run();
}

}  // namespace etendue::mitsuba::test
