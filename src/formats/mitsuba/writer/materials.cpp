#include "formats/mitsuba/writer/materials.h"

#include <algorithm>

namespace etendue::mitsuba {
namespace {

constexpr float kLeastRoughness = 1e-4f;

/// Whether Mitsuba shows such a surface black from behind.
struct IsBlackFromBehind {
  bool operator()(const scene::DiffuseMaterial&) const { return true; }
  bool operator()(const scene::MirrorMaterial&) const { return true; }
  bool operator()(const scene::ConductorMaterial&) const { return true; }
  bool operator()(const scene::PlasticMaterial&) const { return true; }
  bool operator()(const auto&) const { return false; }
};

const char* word(scene::Microfacets microfacets) {
  return microfacets == scene::Microfacets::ggx ? "ggx" : "beckmann";
}

/// Inside over outside.
void add_ior(pugi::xml_node node, float ior) {
  add_number(node, "int_ior", ior);
  add_number(node, "ext_ior", 1);
}

void add_handling(pugi::xml_node node, const scene::TiltHandling& handling) {
  add_flag(node, "flip_invalid_normals", handling.turn_back, true);
  add_flag(node, "use_shadowing_function", handling.cast_shadows, true);
}

}  // namespace

/// Where a surface is written, and for which material.
struct MaterialWriter::Target {
  const scene::Material& material;
  pugi::xml_node parent;
  std::string id;  ///< empty within another

  pugi::xml_node add(const std::string& type) const { return add_object(parent, "bsdf", type, id); }
};

const std::string& MaterialWriter::id(scene::Id<scene::Material> id) {
  const auto [place, is_new] = ids_.try_emplace(id.index);
  if (!is_new) return place->second;
  const scene::Material& material = context_.scene.materials[id.index];
  place->second = context_.ids.unique(material.name, "material");
  const Target outer{material, elements_, place->second};
  const bool shows_both_sides = !material.one_sided && std::visit(IsBlackFromBehind{}, material.surface);
  const Target target = shows_both_sides ? Target{material, outer.add("twosided"), {}} : outer;
  std::visit([&](const auto& surface) { write(surface, target); }, material.surface);
  return place->second;
}

void MaterialWriter::write(const scene::DiffuseMaterial& m, const Target& target) {
  textures_.add(target.add("diffuse"), "reflectance", m.reflectance);
}

void MaterialWriter::write(const scene::MirrorMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("conductor");
  add_text(node, "material", "none");
  add_reflectance(node, "specular_reflectance", m.reflectance);
}

void MaterialWriter::write(const scene::GlassMaterial& m, const Target& target) {
  if (m.fresnel == scene::Fresnel::schlick)
    context_.written_instead("Mitsuba knows no approximation of glass by Schlick; its exact reflectance is written",
                             target.material.where);
  const pugi::xml_node node = target.add("dielectric");
  add_ior(node, m.ior);
  add_reflectance(node, "specular_reflectance", m.reflectance);
  add_reflectance(node, "specular_transmittance", m.transmittance);
}

void MaterialWriter::write(const scene::RefractionMaterial& m, const Target& target) {
  context_.written_instead(
      "Mitsuba knows no surface that refracts all light; glass without reflection is written, which loses some of it",
      target.material.where);
  const pugi::xml_node node = target.add("dielectric");
  add_ior(node, m.ior);
  add_reflectance(node, "specular_reflectance", Spectrum(0));
  add_reflectance(node, "specular_transmittance", m.transmittance);
}

void MaterialWriter::add_roughness(pugi::xml_node node, const scene::FloatInput& u, const scene::FloatInput& v,
                                   const Target& target) {
  const auto add = [&](const char* name, scene::FloatInput alpha) {
    if (float* constant = std::get_if<float>(&alpha); constant != nullptr && *constant < kLeastRoughness) {
      context_.written_instead("a roughness is below 0.0001, the least that Mitsuba knows; 0.0001 is written",
                               target.material.where);
      *constant = kLeastRoughness;
    }
    textures_.add(node, name, alpha);
  };
  if (u == v) {
    add("alpha", u);
  } else {
    add("alpha_u", u);
    add("alpha_v", v);
  }
}

void MaterialWriter::write(const scene::ConductorMaterial& m, const Target& target) {
  const scene::FloatInput smooth = 0.0f;
  const bool is_smooth = m.alpha_u == smooth && m.alpha_v == smooth;
  const pugi::xml_node node = target.add(is_smooth ? "conductor" : "roughconductor");
  add_color(node, "eta", m.eta);
  add_color(node, "k", m.k);
  textures_.add(node, "specular_reflectance", m.reflectance);
  if (is_smooth) return;
  add_text(node, "distribution", word(m.distribution));
  add_roughness(node, m.alpha_u, m.alpha_v, target);
}

void MaterialWriter::write(const scene::NoReflection&, const Target& target) {
  add_color(target.add("diffuse"), "reflectance", Spectrum(0));
}

void MaterialWriter::write(const scene::ThinGlassMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("thindielectric");
  add_ior(node, m.ior);
  textures_.add(node, "specular_reflectance", m.reflectance);
  textures_.add(node, "specular_transmittance", m.transmittance);
}

void MaterialWriter::write(const scene::RoughGlassMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("roughdielectric");
  add_ior(node, m.ior);
  textures_.add(node, "specular_reflectance", m.reflectance);
  textures_.add(node, "specular_transmittance", m.transmittance);
  add_text(node, "distribution", word(m.distribution));
  add_roughness(node, m.alpha_u, m.alpha_v, target);
}

void MaterialWriter::write(const scene::PlasticMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add(m.alpha > 0 ? "roughplastic" : "plastic");
  add_ior(node, m.ior);
  textures_.add(node, "diffuse_reflectance", m.diffuse);
  textures_.add(node, "specular_reflectance", m.specular);
  add_flag(node, "nonlinear", m.nonlinear);
  if (!(m.alpha > 0)) return;
  add_text(node, "distribution", word(m.distribution));
  add_roughness(node, m.alpha, m.alpha, target);
}

void MaterialWriter::write(const scene::PrincipledMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("principled");
  textures_.add(node, "base_color", m.base_color);
  textures_.add(node, "roughness", m.roughness);
  textures_.add(node, "anisotropic", m.anisotropic);
  textures_.add(node, "metallic", m.metallic);
  textures_.add(node, "spec_trans", m.spec_trans);
  textures_.add(node, "spec_tint", m.spec_tint);
  textures_.add(node, "sheen", m.sheen);
  textures_.add(node, "sheen_tint", m.sheen_tint);
  textures_.add(node, "flatness", m.flatness);
  textures_.add(node, "clearcoat", m.clearcoat);
  textures_.add(node, "clearcoat_gloss", m.clearcoat_gloss);
  add_number(node, "eta", m.eta);
  add_number(node, "main_specular_sampling_rate", m.main_specular_rate);
  add_number(node, "clearcoat_sampling_rate", m.clearcoat_rate);
  add_number(node, "diffuse_reflectance_sampling_rate", m.diffuse_rate);
}

void MaterialWriter::write(const scene::PrincipledThinMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("principledthin");
  textures_.add(node, "base_color", m.base_color);
  textures_.add(node, "roughness", m.roughness);
  textures_.add(node, "anisotropic", m.anisotropic);
  textures_.add(node, "spec_trans", m.spec_trans);
  textures_.add(node, "eta", m.eta);
  textures_.add(node, "spec_tint", m.spec_tint);
  textures_.add(node, "sheen", m.sheen);
  textures_.add(node, "sheen_tint", m.sheen_tint);
  textures_.add(node, "flatness", m.flatness);
  textures_.add(node, "diff_trans", m.diff_trans);
  add_number(node, "specular_reflectance_sampling_rate", m.specular_reflection_rate);
  add_number(node, "specular_transmittance_sampling_rate", m.specular_transmission_rate);
  add_number(node, "diffuse_reflectance_sampling_rate", m.diffuse_rate);
  add_number(node, "diffuse_transmittance_sampling_rate", m.diffuse_transmission_rate);
}

void MaterialWriter::write(const scene::NullMaterial&, const Target& target) {
  target.add("null");
}

void MaterialWriter::write(const scene::BlendMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("blendbsdf");
  textures_.add(node, "weight", m.weight);
  add_reference(node, {}, id(m.first));
  add_reference(node, {}, id(m.second));
}

void MaterialWriter::write(const scene::MaskMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("mask");
  textures_.add(node, "opacity", m.opacity);
  add_reference(node, {}, id(m.inner));
}

void MaterialWriter::write(const scene::TwoSidedMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("twosided");
  add_reference(node, {}, id(m.front));
  if (m.back != m.front) add_reference(node, {}, id(m.back));
}

void MaterialWriter::write(const scene::BumpMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("bumpmap");
  textures_.add(node, {}, m.height, TextureWriter::Use::number);
  add_number(node, "scale", m.scale);
  add_handling(node, m.handling);
  add_reference(node, {}, id(m.inner));
}

void MaterialWriter::write(const scene::NormalMapMaterial& m, const Target& target) {
  const pugi::xml_node node = target.add("normalmap");
  textures_.add(node, "normalmap", m.normals, TextureWriter::Use::color);
  add_handling(node, m.handling);
  add_reference(node, {}, id(m.inner));
}

}  // namespace etendue::mitsuba
