#include "render/material_compiler.h"

#include <fmt/format.h>

#include <limits>
#include <map>
#include <tuple>

#include "base/error.h"

namespace etendue {
namespace {

MicrofacetKind kind_of(scene::Microfacets microfacets) {
  return microfacets == scene::Microfacets::ggx ? MicrofacetKind::ggx : MicrofacetKind::beckmann;
}

UvMap compile_uv(const scene::UvTransform& t) {
  return {{t.x[0], t.x[1]}, {t.y[0], t.y[1]}, {t.offset[0], t.offset[1]}};
}

TexelWrap compile_wrap(scene::TextureWrap wrap) {
  switch (wrap) {
    case scene::TextureWrap::repeat:
      return TexelWrap::repeat;
    case scene::TextureWrap::mirror:
      return TexelWrap::mirror;
    case scene::TextureWrap::clamp:
      return TexelWrap::clamp;
  }
  return TexelWrap::repeat;
}

const std::uint32_t* texture_of(const scene::ColorInput& input) {
  const auto* id = std::get_if<scene::Id<scene::Texture>>(&input);
  return id == nullptr ? nullptr : &id->index;
}

/// Which textures give off light: only their texels may exceed 1.
std::vector<bool> shining_textures(const scene::SceneDescription& scene) {
  std::vector<bool> shines(scene.textures.size());
  const auto note = [&](const std::uint32_t* texture) {
    if (texture != nullptr) shines[*texture] = true;
  };
  for (const scene::Material& material : scene.materials) note(texture_of(material.emission));
  for (const scene::Light& light : scene.lights) {
    if (const auto* projector = std::get_if<scene::ProjectorLight>(&light.source))
      note(texture_of(projector->irradiance));
    if (const auto* spot = std::get_if<scene::SpotLight>(&light.source); spot && spot->texture)
      note(&spot->texture->index);
  }
  return shines;
}

class TextureCompiler {
 public:
  TextureCompiler(const scene::SceneDescription& scene, Geometry& geometry, Diagnostics& diagnostics)
      : scene_(scene), geometry_(geometry), diagnostics_(diagnostics), shines_(shining_textures(scene)) {}

  Textures run() {
    Textures textures;
    for (const scene::Texture& texture : scene_.textures) {
      try {
        textures.push_back(std::visit(
            [&](const auto& source) { return compile(source, texture, shines_[textures.size()]); }, texture.source));
      } catch (const Error& error) {
        diagnostics_.warning(fmt::format("{}; the texture is replaced by grey", error.what()), texture.where);
        textures.push_back(CheckerboardTexture{Spectrum(0.5f), Spectrum(0.5f), {}});
      }
    }
    return textures;
  }

 private:
  Texture compile(const scene::BitmapTexture& source, const scene::Texture& texture, bool shines) {
    BitmapTexture out{read_texels(source.file, source.raw ? ColorEncoding::linear : ColorEncoding::srgb),
                      source.filter == scene::TextureFilter::nearest ? TexelFilter::nearest : TexelFilter::bilinear,
                      compile_wrap(source.wrap), compile_uv(texture.to_uv)};
    const float most = shines || source.raw ? std::numeric_limits<float>::max() : 1.0f;
    diagnostics_.repaired(shines ? "texel that no light can have (negative, infinite or NaN) repaired"
                                 : "texel that is no reflectance between 0 and 1 brought there",
                          texture.where, out.texels.clamp(most));
    return out;
  }
  Texture compile(const scene::CheckerboardTexture& source, const scene::Texture& texture, bool) {
    return CheckerboardTexture{compile_input(source.color0), compile_input(source.color1), compile_uv(texture.to_uv)};
  }
  Texture compile(const scene::MeshAttributeTexture& source, const scene::Texture&, bool) {
    return AttributeTexture{geometry_.attribute_id(source.attribute), source.scale};
  }
  Texture compile(const scene::VolumeTexture& source, const scene::Texture&, bool) {
    return VolumeTexture{Volume(scene_.volumes[source.volume.index])};
  }

  const scene::SceneDescription& scene_;
  Geometry& geometry_;
  Diagnostics& diagnostics_;
  std::vector<bool> shines_;
};

class MaterialCompiler {
 public:
  MaterialCompiler(const scene::SceneDescription& scene, const CompileOptions& options)
      : scene_(scene), options_(options) {}

  Material compile(const scene::Material& material) {
    Material out = std::visit([&](const auto& surface) { return compile(surface); }, material.surface);
    out.emission = compile_input(material.emission);
    out.one_sided = material.one_sided;
    return out;
  }

 private:
  Material compile(const scene::DiffuseMaterial& m) const {
    const ColorSource reflectance = compile_input(m.reflectance);
    if (const auto* constant = std::get_if<Spectrum>(&reflectance)) return {UniformMaterial{DiffuseBsdf{*constant}}};
    return {DiffuseMaterial{reflectance}};
  }
  Material compile(const scene::MirrorMaterial& m) const { return {UniformMaterial{MirrorBsdf{m.reflectance}}}; }
  Material compile(const scene::GlassMaterial& m) const {
    const bool schlick = options_.fresnel.value_or(m.fresnel) == scene::Fresnel::schlick;
    return {UniformMaterial{
        DielectricBsdf{m.reflectance, m.transmittance, m.ior, schlick ? Boundary::schlick : Boundary::fresnel}}};
  }
  Material compile(const scene::ThinGlassMaterial& m) const {
    return {ThinGlassMaterial{compile_input(m.reflectance), compile_input(m.transmittance), m.ior}};
  }
  Material compile(const scene::RefractionMaterial& m) const {
    return {UniformMaterial{DielectricBsdf{Spectrum(0), m.transmittance, m.ior, Boundary::transmit_only}}};
  }
  Material compile(const scene::RoughGlassMaterial& m) const {
    return {RoughGlassMaterial{compile_input(m.reflectance), compile_input(m.transmittance), m.ior,
                               kind_of(m.distribution), compile_input(m.alpha_u), compile_input(m.alpha_v)}};
  }
  Material compile(const scene::ConductorMaterial& m) const {
    const auto reflectance = compile_input(m.reflectance);
    const auto* constant = std::get_if<Spectrum>(&m.reflectance);
    const float *u = std::get_if<float>(&m.alpha_u), *v = std::get_if<float>(&m.alpha_v);
    if (u && v && *u == 0 && *v == 0) {
      if (constant) return {UniformMaterial{MirrorBsdf{*constant, m.eta, m.k}}};
      return {SmoothConductorMaterial{m.eta, m.k, reflectance}};
    }
    if (u && v && constant && *u == *v)
      return {
          UniformMaterial{ConductorBsdf{m.eta, m.k, *constant, MicrofacetDistribution(kind_of(m.distribution), *u)}}};
    return {ConductorMaterial{m.eta, m.k, reflectance, kind_of(m.distribution), compile_input(m.alpha_u),
                              compile_input(m.alpha_v)}};
  }
  Material compile(const scene::PlasticMaterial& m) {
    return {PlasticMaterial{compile_input(m.diffuse), compile_input(m.specular), boundary(m), m.nonlinear}};
  }
  Material compile(const scene::PrincipledMaterial& m) const {
    PrincipledParameters fixed;
    fixed.eta = m.eta;
    fixed.main_specular_rate = m.main_specular_rate;
    fixed.clearcoat_rate = m.clearcoat_rate;
    fixed.diffuse_rate = m.diffuse_rate;
    return {PrincipledMaterial{compile_input(m.base_color), compile_input(m.roughness), compile_input(m.anisotropic),
                               compile_input(m.metallic), compile_input(m.spec_trans), compile_input(m.spec_tint),
                               compile_input(m.sheen), compile_input(m.sheen_tint), compile_input(m.flatness),
                               compile_input(m.clearcoat), compile_input(m.clearcoat_gloss), fixed}};
  }
  Material compile(const scene::PrincipledThinMaterial& m) const {
    PrincipledThinParameters fixed;
    fixed.specular_reflection_rate = m.specular_reflection_rate;
    fixed.specular_transmission_rate = m.specular_transmission_rate;
    fixed.diffuse_rate = m.diffuse_rate;
    fixed.diffuse_transmission_rate = m.diffuse_transmission_rate;
    return {PrincipledThinMaterial{compile_input(m.base_color), compile_input(m.roughness),
                                   compile_input(m.anisotropic), compile_input(m.spec_trans), compile_input(m.eta),
                                   compile_input(m.spec_tint), compile_input(m.sheen), compile_input(m.sheen_tint),
                                   compile_input(m.flatness), compile_input(m.diff_trans), fixed}};
  }
  Material compile(const scene::NullMaterial&) const { return {NullMaterial{}}; }
  Material compile(const scene::NoReflection&) const { return {UniformMaterial{BlackBsdf{}}}; }
  Material compile(const scene::BlendMaterial& m) const {
    return {BlendMaterial{m.first.index, m.second.index, compile_input(m.weight)}};
  }
  Material compile(const scene::MaskMaterial& m) const {
    return {MaskMaterial{m.inner.index, compile_input(m.opacity)}};
  }
  Material compile(const scene::TwoSidedMaterial& m) const { return {TwoSidedMaterial{m.front.index, m.back.index}}; }
  Material compile(const scene::BumpMaterial& m) const {
    return {BumpMaterial{m.inner.index, m.height.index, m.scale, m.handling}};
  }
  Material compile(const scene::NormalMapMaterial& m) const {
    return {NormalMapMaterial{m.inner.index, m.normals.index, m.handling}};
  }

  /// Rough ones are tabulated, which takes many milliseconds: materials that have the same share it.
  std::shared_ptr<const PlasticBoundary> boundary(const scene::PlasticMaterial& m) {
    std::shared_ptr<const PlasticBoundary>& shared = boundaries_[{m.ior, m.alpha, m.distribution}];
    if (shared) return shared;
    if (m.alpha > 0)
      shared = std::make_shared<const PlasticBoundary>(m.ior, MicrofacetDistribution(kind_of(m.distribution), m.alpha));
    else
      shared = std::make_shared<const PlasticBoundary>(m.ior);
    return shared;
  }

  std::map<std::tuple<float, float, scene::Microfacets>, std::shared_ptr<const PlasticBoundary>> boundaries_;
  const scene::SceneDescription& scene_;
  const CompileOptions& options_;
};

/// The materials that a surface names.
struct InnerMaterials {
  std::vector<std::uint32_t> operator()(const scene::BlendMaterial& m) const { return {m.first.index, m.second.index}; }
  std::vector<std::uint32_t> operator()(const scene::MaskMaterial& m) const { return {m.inner.index}; }
  std::vector<std::uint32_t> operator()(const scene::TwoSidedMaterial& m) const {
    return {m.front.index, m.back.index};
  }
  std::vector<std::uint32_t> operator()(const scene::BumpMaterial& m) const { return {m.inner.index}; }
  std::vector<std::uint32_t> operator()(const scene::NormalMapMaterial& m) const { return {m.inner.index}; }
  std::vector<std::uint32_t> operator()(const auto&) const { return {}; }
};

std::vector<std::uint32_t> inner_materials(const scene::Material& material) {
  return std::visit(InnerMaterials{}, material.surface);
}

/// Whether following inner materials from `start` comes back to it.
bool contains_itself(const scene::SceneDescription& scene, std::uint32_t start) {
  std::vector<bool> seen(scene.materials.size());
  std::vector<std::uint32_t> open = inner_materials(scene.materials[start]);
  while (!open.empty()) {
    const std::uint32_t next = open.back();
    open.pop_back();
    if (next == start) return true;
    if (seen[next]) continue;
    seen[next] = true;
    for (const std::uint32_t inner : inner_materials(scene.materials[next])) open.push_back(inner);
  }
  return false;
}

}  // namespace

ColorSource compile_input(const scene::ColorInput& input) {
  if (const std::uint32_t* texture = texture_of(input)) return *texture;
  return std::get<Spectrum>(input);
}

FloatSource compile_input(const scene::FloatInput& input) {
  if (const auto* id = std::get_if<scene::Id<scene::Texture>>(&input)) return id->index;
  return std::get<float>(input);
}

Textures compile_textures(const scene::SceneDescription& scene, Geometry& geometry, Diagnostics& diagnostics) {
  return TextureCompiler(scene, geometry, diagnostics).run();
}

Materials compile_materials(const scene::SceneDescription& scene, const CompileOptions& options,
                            Diagnostics& diagnostics) {
  MaterialCompiler compiler(scene, options);
  Materials materials;
  for (std::uint32_t i = 0; i < scene.materials.size(); ++i) {
    const scene::Material& material = scene.materials[i];
    if (contains_itself(scene, i)) {
      diagnostics.warning(fmt::format("the material \"{}\" contains itself; it is replaced by grey", material.name),
                          material.where);
      materials.push_back({UniformMaterial{DiffuseBsdf{Spectrum(0.5f)}}});
      continue;
    }
    materials.push_back(compiler.compile(material));
  }
  resolve_needs(materials);
  return materials;
}

}  // namespace etendue
