#include "formats/mitsuba/materials.h"

#include <fmt/format.h>

#include <cmath>

#include "formats/conductors.h"
#include "formats/mitsuba/ior.h"

namespace etendue::mitsuba {
namespace {

constexpr float kMost = 3e38f;

/// What only one side shows: Mitsuba's opaque surfaces are black from behind.
scene::Material front_only(scene::Surface surface) {
  scene::Material material;
  material.surface = surface;
  material.one_sided = true;
  return material;
}

scene::Material both_sides(scene::Surface surface) {
  scene::Material material;
  material.surface = surface;
  return material;
}

/// Inside over outside.
float relative_ior(Properties& properties, std::string_view missing_inside) {
  const float inside = index_of_refraction(properties, "int_ior", missing_inside);
  return inside / index_of_refraction(properties, "ext_ior", "air");
}

scene::Microfacets distribution(Properties& properties) {
  properties.ignore({"sample_visible"});
  if (properties.object().is_old && properties.choice("distribution", {"beckmann", "ggx", "phong", "as"}) >= 2) {
    properties.report().repaired("a microfacet distribution of version 0.6 is no more; beckmann is used",
                                 properties.where());
    return scene::Microfacets::beckmann;
  }
  return properties.choice("distribution", {"beckmann", "ggx"}) == 1 ? scene::Microfacets::ggx
                                                                     : scene::Microfacets::beckmann;
}

/// The index of refraction that a "specular" of Burley's model stands for: Fresnel reflectance at normal incidence 0.08
/// · specular.
float ior_of_specular(float specular) {
  return 2 / (1 - std::sqrt(0.08f * specular)) - 1;
}

scene::TiltHandling tilt_handling(Properties& properties) {
  return {properties.boolean("flip_invalid_normals", true), properties.boolean("use_shadowing_function", true)};
}

bool is_transmissive(const scene::Surface& surface) {
  return std::holds_alternative<scene::GlassMaterial>(surface) ||
         std::holds_alternative<scene::ThinGlassMaterial>(surface) ||
         std::holds_alternative<scene::RoughGlassMaterial>(surface) ||
         std::holds_alternative<scene::NullMaterial>(surface) || std::holds_alternative<scene::MaskMaterial>(surface) ||
         std::holds_alternative<scene::PrincipledThinMaterial>(surface);
}

}  // namespace

MaterialLibrary::Reader MaterialLibrary::reader_for(std::string_view type) {
  struct Entry {
    std::string_view type;
    Reader read;
  };
  static constexpr Entry kEntries[] = {
      {"blendbsdf", &MaterialLibrary::blend},
      {"bumpmap", &MaterialLibrary::bump_map},
      {"conductor", &MaterialLibrary::conductor},
      {"dielectric", &MaterialLibrary::dielectric},
      {"diffuse", &MaterialLibrary::diffuse},
      {"mask", &MaterialLibrary::mask},
      {"normalmap", &MaterialLibrary::normal_map},
      {"null", &MaterialLibrary::null_surface},
      {"plastic", &MaterialLibrary::plastic},
      {"principled", &MaterialLibrary::principled},
      {"principledthin", &MaterialLibrary::principled_thin},
      {"roughconductor", &MaterialLibrary::rough_conductor},
      {"roughdielectric", &MaterialLibrary::rough_dielectric},
      {"roughplastic", &MaterialLibrary::rough_plastic},
      {"thindielectric", &MaterialLibrary::thin_dielectric},
      {"twosided", &MaterialLibrary::two_sided},
  };
  for (const Entry& entry : kEntries)
    if (entry.type == type) return entry.read;
  return nullptr;
}

scene::Id<scene::Material> MaterialLibrary::add(scene::Material material) {
  scene_.materials.push_back(std::move(material));
  return {static_cast<std::uint32_t>(scene_.materials.size() - 1)};
}

scene::Id<scene::Material> MaterialLibrary::default_material() {
  if (!default_) {
    scene::Material grey = front_only(scene::DiffuseMaterial{});
    grey.name = "default";
    default_ = add(std::move(grey));
  }
  return *default_;
}

scene::Id<scene::Material> MaterialLibrary::black_material() {
  if (!black_) {
    scene::Material black = both_sides(scene::NoReflection{});
    black.name = "black";
    black_ = add(std::move(black));
  }
  return *black_;
}

scene::Id<scene::Material> MaterialLibrary::shining(scene::Id<scene::Material> base,
                                                    const scene::ColorInput& emission) {
  scene::Material material = scene_.materials[base.index];
  material.emission = emission;
  return add(std::move(material));
}

scene::Id<scene::Material> MaterialLibrary::material(const Document& document, const Element& element, Report& report) {
  if (const auto known = known_.find(&element); known != known_.end()) return known->second;
  scene::Id<scene::Material> id;
  try {
    id = add(read(document, element, report));
  } catch (const Problem& problem) {
    report.error(problem);
    id = default_material();
  }
  known_[&element] = id;
  return id;
}

scene::Material MaterialLibrary::read(const Document& document, const Element& element, Report& report) {
  Properties properties(document, element, report);
  scene::Material material = front_only(scene::DiffuseMaterial{});
  if (const Reader reader = reader_for(element.type())) {
    material = (this->*reader)(properties);
    properties.reject_unread();
  } else {
    report.warning(
        fmt::format("the bsdf {} is not known here; a diffuse grey (0.5) is used", in_quotes(element.type())),
        element.where);
  }
  material.name = properties.name();
  material.where = element.where;
  return material;
}

scene::Material MaterialLibrary::diffuse(Properties& properties) {
  return front_only(scene::DiffuseMaterial{textures_.reflectance(properties, "reflectance", 0.5f)});
}

scene::Material MaterialLibrary::dielectric(Properties& properties) {
  scene::GlassMaterial glass;
  glass.ior = relative_ior(properties, "bk7");
  glass.reflectance = textures_.constant(properties, "specular_reflectance", Spectrum(1), SpectrumRole::reflectance);
  glass.transmittance =
      textures_.constant(properties, "specular_transmittance", Spectrum(1), SpectrumRole::reflectance);
  return both_sides(glass);
}

scene::Material MaterialLibrary::thin_dielectric(Properties& properties) {
  scene::ThinGlassMaterial glass;
  glass.ior = relative_ior(properties, "bk7");
  glass.reflectance = textures_.reflectance(properties, "specular_reflectance", 1);
  glass.transmittance = textures_.reflectance(properties, "specular_transmittance", 1);
  return both_sides(glass);
}

scene::Material MaterialLibrary::rough_dielectric(Properties& properties) {
  scene::RoughGlassMaterial glass;
  glass.ior = relative_ior(properties, "bk7");
  if (glass.ior == 1)
    throw Problem("a rough dielectric needs different indices inside and outside; with equal ones write \"null\"",
                  properties.where());
  glass.reflectance = textures_.reflectance(properties, "specular_reflectance", 1);
  glass.transmittance = textures_.reflectance(properties, "specular_transmittance", 1);
  glass.distribution = distribution(properties);
  read_roughness(properties, glass.alpha_u, glass.alpha_v);
  return both_sides(glass);
}

scene::ConductorMaterial MaterialLibrary::metal(Properties& properties) {
  scene::ConductorMaterial metal;
  const std::string name = properties.text("material").value_or("none");
  if (properties.has("eta") || name == "none") {
    if (name != "none") throw Problem("a conductor has either a \"material\" or \"eta\" and \"k\"", properties.where());
    metal.eta = textures_.constant(properties, "eta", Spectrum(0), SpectrumRole::unbounded);
    metal.k = textures_.constant(properties, "k", Spectrum(1), SpectrumRole::unbounded);
  } else if (const auto known = named_conductor(name)) {
    metal.eta = known->eta;
    metal.k = known->k;
    properties.ignore({"k"});
  } else {
    const auto names = conductor_names();
    throw Problem(
        fmt::format("the metal {} is not known{}", in_quotes(name), did_you_mean(name, {names.begin(), names.end()})),
        properties.find("material")->where);
  }
  if (properties.object().is_old) {
    const float outside = properties.has("ext_eta") ? index_of_refraction(properties, "ext_eta", "air") : 1;
    metal.eta *= 1 / outside;
    metal.k *= 1 / outside;
  }
  metal.reflectance = textures_.reflectance(properties, "specular_reflectance", 1);
  return metal;
}

scene::Material MaterialLibrary::conductor(Properties& properties) {
  scene::ConductorMaterial smooth = metal(properties);
  smooth.alpha_u = smooth.alpha_v = 0.0f;
  return front_only(smooth);
}

scene::Material MaterialLibrary::rough_conductor(Properties& properties) {
  scene::ConductorMaterial rough = metal(properties);
  rough.distribution = distribution(properties);
  read_roughness(properties, rough.alpha_u, rough.alpha_v);
  return front_only(rough);
}

/// alpha, or alpha_u and alpha_v.
void MaterialLibrary::read_roughness(Properties& properties, scene::FloatInput& alpha_u, scene::FloatInput& alpha_v) {
  const bool has_u = properties.has("alpha_u"), has_v = properties.has("alpha_v");
  if ((has_u || has_v) && (!has_u || !has_v || properties.has("alpha")))
    throw Problem("roughness is either \"alpha\", or both \"alpha_u\" and \"alpha_v\"", properties.where());
  alpha_u = textures_.number(properties, has_u ? "alpha_u" : "alpha", 0.1f);
  alpha_v = has_v ? textures_.number(properties, "alpha_v", 0.1f) : alpha_u;
  for (scene::FloatInput* alpha : {&alpha_u, &alpha_v})
    if (float* constant = std::get_if<float>(alpha); constant != nullptr && !(*constant >= 1e-4f)) {
      properties.report().repaired("a roughness is below 0.0001; 0.0001 is used", properties.where());
      *constant = 1e-4f;
    }
}

scene::PlasticMaterial MaterialLibrary::plastic_base(Properties& properties) {
  scene::PlasticMaterial plastic;
  plastic.ior = relative_ior(properties, "polypropylene");
  plastic.diffuse = textures_.reflectance(properties, "diffuse_reflectance", 0.5f);
  plastic.specular = textures_.reflectance(properties, "specular_reflectance", 1);
  plastic.nonlinear = properties.boolean("nonlinear", false);
  return plastic;
}

scene::Material MaterialLibrary::plastic(Properties& properties) {
  return front_only(plastic_base(properties));
}

scene::Material MaterialLibrary::rough_plastic(Properties& properties) {
  scene::PlasticMaterial plastic = plastic_base(properties);
  plastic.distribution = distribution(properties);
  plastic.alpha = std::max(properties.number("alpha", 0.1f, 0, kMost), 1e-4f);
  return front_only(plastic);
}

scene::Material MaterialLibrary::principled(Properties& properties) {
  scene::PrincipledMaterial m;
  m.base_color = textures_.reflectance(properties, "base_color", 0.5f);
  const auto number = [&](std::string_view name, float missing) { return textures_.number(properties, name, missing); };
  m.roughness = number("roughness", 0.5f);
  m.anisotropic = number("anisotropic", 0);
  m.metallic = number("metallic", 0);
  m.spec_trans = number("spec_trans", 0);
  m.spec_tint = number("spec_tint", 0);
  m.sheen = number("sheen", 0);
  m.sheen_tint = number("sheen_tint", 0);
  m.flatness = number("flatness", 0);
  m.clearcoat = number("clearcoat", 0);
  m.clearcoat_gloss = number("clearcoat_gloss", 0);
  m.main_specular_rate = properties.number("main_specular_sampling_rate", 1, 0, kMost);
  m.clearcoat_rate = properties.number("clearcoat_sampling_rate", 1, 0, kMost);
  m.diffuse_rate = properties.number("diffuse_reflectance_sampling_rate", 1, 0, kMost);
  if (properties.has("eta") && properties.has("specular"))
    throw Problem("\"eta\" and \"specular\" say the same; one of them is enough", properties.where());
  const bool is_clear = m.spec_trans != scene::FloatInput(0.0f);
  if (properties.has("eta")) {
    m.eta = properties.number("eta", 1.5f, 1e-3f, kMost);
    if (is_clear && m.eta == 1) m.eta = 1.001f;
  } else {
    m.eta = ior_of_specular(std::max(properties.number("specular", 0.5f, 0, 12), is_clear ? 1e-3f : 0.0f));
  }
  return both_sides(m);
}

scene::Material MaterialLibrary::principled_thin(Properties& properties) {
  scene::PrincipledThinMaterial m;
  m.base_color = textures_.reflectance(properties, "base_color", 0.5f);
  const auto number = [&](std::string_view name, float missing) { return textures_.number(properties, name, missing); };
  m.roughness = number("roughness", 0.5f);
  m.anisotropic = number("anisotropic", 0);
  m.spec_trans = number("spec_trans", 0);
  m.eta = number("eta", 1.5f);
  m.spec_tint = number("spec_tint", 0);
  m.sheen = number("sheen", 0);
  m.sheen_tint = number("sheen_tint", 0);
  m.flatness = number("flatness", 0);
  m.diff_trans = number("diff_trans", 0);
  m.specular_reflection_rate = properties.number("specular_reflectance_sampling_rate", 1, 0, kMost);
  m.specular_transmission_rate = properties.number("specular_transmittance_sampling_rate", 1, 0, kMost);
  m.diffuse_rate = properties.number("diffuse_reflectance_sampling_rate", 1, 0, kMost);
  m.diffuse_transmission_rate = properties.number("diffuse_transmittance_sampling_rate", 1, 0, kMost);
  return both_sides(m);
}

/// The one <bsdf> within another.
scene::Id<scene::Material> MaterialLibrary::nested(Properties& properties) {
  const Element* inner = properties.object("bsdf");
  if (inner == nullptr)
    throw Problem(fmt::format("{} needs a <bsdf> in it", in_quotes(properties.type())), properties.where());
  return material(properties.document(), *inner, properties.report());
}

scene::Material MaterialLibrary::blend(Properties& properties) {
  const std::vector<const Element*> inner = properties.objects("bsdf");
  if (inner.size() != 2)
    throw Problem(fmt::format("\"blendbsdf\" needs two <bsdf>s in it, it has {}", inner.size()), properties.where());
  if (!properties.has("weight")) throw Problem("\"blendbsdf\" needs a \"weight\"", properties.where());
  const auto first = material(properties.document(), *inner[0], properties.report());
  const auto second = material(properties.document(), *inner[1], properties.report());
  scene::Material result =
      both_sides(scene::BlendMaterial{first, second, textures_.number(properties, "weight", 0.5f)});
  result.one_sided = is_one_sided(first) && is_one_sided(second);
  return result;
}

scene::Material MaterialLibrary::mask(Properties& properties) {
  const scene::Id<scene::Material> inner = nested(properties);
  return both_sides(scene::MaskMaterial{inner, textures_.number(properties, "opacity", 0.5f)});
}

scene::Material MaterialLibrary::two_sided(Properties& properties) {
  const std::vector<const Element*> inner = properties.objects("bsdf");
  if (inner.empty() || inner.size() > 2)
    throw Problem(fmt::format("\"twosided\" needs one <bsdf> in it or two, it has {}", inner.size()),
                  properties.where());
  properties.ignore({"allow_transmission"});
  const auto front = material(properties.document(), *inner.front(), properties.report());
  const auto back = material(properties.document(), *inner.back(), properties.report());
  for (const auto side : {front, back})
    if (is_transmissive(scene_.materials[side.index].surface))
      throw Problem("\"twosided\" is for surfaces that let nothing through", properties.where());
  scene::Material same = scene_.materials[front.index];
  const bool is_symmetric = std::holds_alternative<scene::DiffuseMaterial>(same.surface) ||
                            std::holds_alternative<scene::ConductorMaterial>(same.surface);
  if (front != back || !is_symmetric) return both_sides(scene::TwoSidedMaterial{front, back});
  same.one_sided = false;
  return same;
}

scene::Material MaterialLibrary::bump_map(Properties& properties) {
  const scene::Id<scene::Material> inner = nested(properties);
  const Element* height = properties.object("texture");
  if (height == nullptr) throw Problem("\"bumpmap\" needs a <texture> in it", properties.where());
  const float scale = properties.number("scale", 1);
  const scene::TiltHandling handling = tilt_handling(properties);
  const auto texture =
      textures_.texture(properties.document(), *height, TextureLibrary::Use::number, properties.report());
  if (!texture) return scene_.materials[inner.index];
  scene::Material result = both_sides(scene::BumpMaterial{inner, *texture, scale, handling});
  result.one_sided = is_one_sided(inner);
  return result;
}

scene::Material MaterialLibrary::normal_map(Properties& properties) {
  const scene::Id<scene::Material> inner = nested(properties);
  const Element* normals = properties.find("normalmap");
  if (normals == nullptr) throw Problem("\"normalmap\" needs a <texture name=\"normalmap\"> in it", properties.where());
  const scene::TiltHandling handling = tilt_handling(properties);
  if (is_constant_color(*normals))
    throw Problem("\"normalmap\" needs a picture; one colour for all is no map", normals->where);
  const auto texture =
      textures_.texture(properties.document(), *normals, TextureLibrary::Use::color, properties.report());
  if (!texture) return scene_.materials[inner.index];
  scene::Material result = both_sides(scene::NormalMapMaterial{inner, *texture, handling});
  result.one_sided = is_one_sided(inner);
  return result;
}

scene::Material MaterialLibrary::null_surface(Properties&) {
  return both_sides(scene::NullMaterial{});
}

}  // namespace etendue::mitsuba
