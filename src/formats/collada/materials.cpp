#include "formats/collada/materials.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/collada/numbers.h"

namespace etendue::collada {
namespace {

constexpr int kMostIndirections = 8;  ///< sampler → surface → image is two

/// The CGL technique of an effect, which may stand in the effect, its profile or the profile's technique.
pugi::xml_node cgl_of_effect(pugi::xml_node effect) {
  const pugi::xml_node profile = effect.child("profile_COMMON");
  for (const pugi::xml_node place : {effect, profile, profile.child("technique")})
    if (const pugi::xml_node technique = cgl_technique(place)) return technique;
  return {};
}

pugi::xml_node first_element(pugi::xml_node parent) {
  return parent.find_child([](pugi::xml_node child) { return child.type() == pugi::node_element; });
}

bool is_cgl_model(std::string_view name) {
  return name == "emission" || name == "mirror" || name == "glass" || name == "refraction" || name == "microfacet" ||
         name == "diffuse";
}

pugi::xml_node required_child(const Document& document, pugi::xml_node parent, const char* name) {
  const pugi::xml_node child = parent.child(name);
  if (!child) throw Problem(fmt::format("<{}> needs a <{}>", parent.name(), name), document.locate(parent));
  return child;
}

/// An image's file name as it may stand in init_from: percent-encoded, with "file:" before it, or with backslashes.
std::string file_name(std::string_view uri) {
  if (uri.starts_with("file://"))
    uri.remove_prefix(7);
  else if (uri.starts_with("file:"))
    uri.remove_prefix(5);
  if (uri.size() > 2 && uri[0] == '/' && uri[2] == ':') uri.remove_prefix(1);  // /C:/… → C:/…
  std::string name = percent_decoded(uri);
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

}  // namespace

scene::Id<scene::Material> MaterialLibrary::add(scene::Material material) {
  materials_.push_back(std::move(material));
  return {static_cast<std::uint32_t>(materials_.size() - 1)};
}

scene::Id<scene::Material> MaterialLibrary::default_material() {
  if (!default_) {
    scene::Material grey;
    grey.name = "default";
    default_ = add(std::move(grey));
  }
  return *default_;
}

scene::Id<scene::Material> MaterialLibrary::material(pugi::xml_node element) {
  if (const auto known = by_element_.find(element.internal_object()); known != by_element_.end()) return known->second;
  scene::Id<scene::Material> id;
  try {
    id = add(read(element));
  } catch (const Problem& problem) {
    report_.error(problem);
    id = default_material();
  }
  by_element_.emplace(element.internal_object(), id);
  return id;
}

scene::Material MaterialLibrary::read(pugi::xml_node element) {
  const pugi::xml_node instance = required_child(document_, element, "instance_effect");
  const pugi::xml_node effect = document_.referenced(instance, "url", "effect");
  const pugi::xml_node cgl = cgl_of_effect(effect);
  const pugi::xml_node cgl_model = first_element(cgl);
  const pugi::xml_node profile = effect.child("profile_COMMON");
  const pugi::xml_node technique = profile.child("technique");

  scene::Material material;
  if (is_cgl_model(cgl_model.name())) {
    material = read_cgl(cgl_model);
  } else {
    if (cgl)
      report_.warning(
          fmt::format("the CGL technique of the effect {} has no surface known here; profile_COMMON is used",
                      in_quotes(name_of(effect))),
          document_.locate(cgl));
    pugi::xml_node model;
    for (const char* const name : {"phong", "lambert", "blinn", "constant"})
      if (!model) model = technique.child(name);
    if (model)
      material = read_common({effect, profile, instance}, model);
    else
      report_.warning(fmt::format("the effect {} has neither a CGL surface nor a profile_COMMON; grey (0.5) is used",
                                  in_quotes(name_of(effect))),
                      document_.locate(effect));
  }
  material.name = name_of(element);
  material.where = document_.locate(element);
  return material;
}

scene::Material MaterialLibrary::read_cgl(pugi::xml_node model) {
  const std::string_view kind = model.name();
  scene::Material material;
  if (kind == "emission") {
    material.surface = scene::NoReflection{};
    material.emission = radiance(required_child(document_, model, "radiance"));
  } else if (kind == "mirror") {
    material.surface = scene::MirrorMaterial{tint(model, "reflectance")};
  } else if (kind == "glass") {
    warn_about_roughness(model);
    material.surface = scene::GlassMaterial{tint(model, "reflectance"), tint(model, "transmittance"),
                                            index_of_refraction(model), scene::Fresnel::schlick};
  } else if (kind == "refraction") {
    warn_about_roughness(model);
    material.surface = scene::RefractionMaterial{tint(model, "transmittance"), index_of_refraction(model)};
  } else if (kind == "microfacet") {
    const float alpha = read_number(document_, required_child(document_, model, "alpha"));
    if (!(alpha > 0) || !std::isfinite(alpha))
      throw Problem(fmt::format("the roughness alpha={} is not above zero; for a smooth metal use <mirror>", alpha),
                    document_.locate(model.child("alpha")));
    material.surface = scene::ConductorMaterial{color(required_child(document_, model, "eta")),
                                                color(required_child(document_, model, "k")),
                                                alpha,
                                                alpha,
                                                scene::Microfacets::beckmann,
                                                tint(model, "reflectance")};
  } else {
    const pugi::xml_node given = model.child("reflectance") ? model.child("reflectance") : model.child("color");
    material.surface = scene::DiffuseMaterial{given ? reflectance(given) : Spectrum(0.5f)};
  }
  return material;
}

scene::Material MaterialLibrary::read_common(const Effect& effect, pugi::xml_node model) {
  scene::Material material;
  material.emission = emission(effect, model.child("emission"));
  if (const pugi::xml_node slot = model.child("diffuse"))
    material.surface = scene::DiffuseMaterial{diffuse(effect, slot)};
  else
    material.surface = scene::NoReflection{};
  return material;
}

scene::ColorInput MaterialLibrary::diffuse(const Effect& effect, pugi::xml_node slot) {
  if (const pugi::xml_node element = slot.child("texture")) {
    if (const auto id = texture(effect, element)) return *id;
    return Spectrum(0.5f);
  }
  if (const pugi::xml_node param = slot.child("param"))
    if (const pugi::xml_node value = first_element(parameter(effect, param.attribute("ref").value())))
      return reflectance(value);
  if (const pugi::xml_node value = slot.child("color")) return reflectance(value);
  report_.repaired("a <diffuse> has neither a colour nor a texture; grey (0.5) is used", document_.locate(slot));
  return Spectrum(0.5f);
}

Spectrum MaterialLibrary::emission(const Effect& effect, pugi::xml_node slot) {
  if (const pugi::xml_node value = slot.child("color")) return radiance(value);
  if (const pugi::xml_node param = slot.child("param"))
    if (const pugi::xml_node value = first_element(parameter(effect, param.attribute("ref").value())))
      return radiance(value);
  if (slot.child("texture"))
    report_.repaired("an emission has a texture; only colours can shine, it stays dark", document_.locate(slot));
  return Spectrum(0);
}

/// The <setparam> or <newparam> called `name` that the effect sees.
pugi::xml_node MaterialLibrary::parameter(const Effect& effect, std::string_view name) const {
  const auto is_it = [&](pugi::xml_node child) {
    const std::string_view kind = child.name();
    return (kind == "newparam" && child.attribute("sid").value() == name) ||
           (kind == "setparam" && child.attribute("ref").value() == name);
  };
  for (const pugi::xml_node scope : {effect.instance, effect.profile, effect.element})
    if (const pugi::xml_node found = scope.find_child(is_it)) return found;
  return {};
}

/// The <image> behind a texture's name: a sampler, whose source is a surface, whose init_from is the image — or, as
/// some exporters write, any of these left out.
pugi::xml_node MaterialLibrary::image_of(const Effect& effect, std::string_view name) const {
  for (int i = 0; i < kMostIndirections; ++i) {
    const pugi::xml_node param = parameter(effect, name);
    if (!param) break;
    if (const pugi::xml_node sampler = param.child("sampler2D")) {
      if (const pugi::xml_node instance = sampler.child("instance_image"))  // COLLADA 1.5
        return document_.referenced(instance, "url", "image");
      name = trimmed_text(sampler.child("source"));
    } else {
      name = trimmed_text(param.child("surface").child("init_from"));
    }
  }
  return document_.find("image", name);
}

std::optional<scene::Id<scene::Texture>> MaterialLibrary::texture(const Effect& effect, pugi::xml_node element) {
  const std::string_view name = element.attribute("texture").value();
  const pugi::xml_node image = image_of(effect, name);
  const pugi::xml_node init_from = image.child("init_from");
  if (!init_from) {
    report_.warning(fmt::format("the texture {} names no image with a file; grey (0.5) is used", in_quotes(name)),
                    document_.locate(element));
    return std::nullopt;
  }
  const auto [place, is_new] = by_image_.try_emplace(image.internal_object());
  if (is_new) {
    place->second = {static_cast<std::uint32_t>(textures_.size())};
    textures_.push_back({name_of(image), scene::BitmapTexture{image_file(init_from)}, {}, document_.locate(init_from)});
  }
  return place->second;
}

/// Names that do not exist as they stand are looked for in the document's folder: many files carry the paths of the
/// machine that they were made on.
std::filesystem::path MaterialLibrary::image_file(pugi::xml_node init_from) {
  const pugi::xml_node ref = init_from.child("ref");  // COLLADA 1.5
  const std::filesystem::path named = file_name(trimmed_text(ref ? ref : init_from));
  const std::filesystem::path file = document_.folder() / named;
  const std::filesystem::path beside = document_.folder() / named.filename();
  std::error_code ignored;
  return !std::filesystem::exists(file, ignored) && std::filesystem::exists(beside, ignored) ? beside : file;
}

/// Three numbers, or four with an alpha that is ignored.
Spectrum MaterialLibrary::color(pugi::xml_node element) const {
  const std::vector<float> v = read_numbers(document_, element, 3, 4);
  const Spectrum result(v[0], v[1], v[2]);
  if (!is_finite(result))
    throw Problem(fmt::format("<{}> is not a finite colour", element.name()), document_.locate(element));
  return result;
}

Spectrum MaterialLibrary::radiance(pugi::xml_node element) {
  const Spectrum c = color(element);
  const Spectrum positive(std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f));
  if (!(c == positive)) report_.repaired("a radiance is negative; 0 is used", document_.locate(element));
  return positive;
}

Spectrum MaterialLibrary::reflectance(pugi::xml_node element) {
  const Spectrum c = color(element);
  const Spectrum possible(std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f));
  if (!(c == possible))
    report_.repaired("a reflectance is outside 0 … 1, which no surface has; it is clamped", document_.locate(element));
  return possible;
}

Spectrum MaterialLibrary::tint(pugi::xml_node model, const char* name) {
  const pugi::xml_node element = model.child(name);
  return element ? reflectance(element) : Spectrum(1);
}

float MaterialLibrary::index_of_refraction(pugi::xml_node model) const {
  const pugi::xml_node element = model.child("ior");
  if (!element) return 1.5f;
  const float ior = read_number(document_, element);
  if (!(ior > 0) || !std::isfinite(ior))
    throw Problem(fmt::format("the index of refraction {} is not above zero", ior), document_.locate(element));
  return ior;
}

void MaterialLibrary::warn_about_roughness(pugi::xml_node model) {
  const pugi::xml_node element = model.child("roughness");
  if (element && read_number(document_, element) != 0)
    report_.repaired("glass and refraction are smooth here; their roughness is ignored", document_.locate(element));
}

}  // namespace etendue::collada
