#include "formats/mitsuba/textures.h"

#include <fmt/format.h>

#include "formats/mitsuba/transforms.h"

namespace etendue::mitsuba {
namespace {

const Spectrum kUnknownTexture(0.5f);

/// The part of a transform that acts on two coordinates.
scene::UvTransform in_plane(const Transform& t) {
  return {{t.x.x, t.x.y}, {t.y.x, t.y.y}, {t.origin.x, t.origin.y}};
}

/// Mitsuba's v = 0 is a picture's top row, ours the bottom one: what follows the transform there is v ↦ 1 − v here.
scene::UvTransform upside_down(const scene::UvTransform& t) {
  return {{t.x[0], -t.x[1]}, {t.y[0], -t.y[1]}, {t.offset[0], 1 - t.offset[1]}};
}

/// (u, v) ↦ (u, 1 − v), then `t`.
scene::UvTransform after_turning_v(const scene::UvTransform& t) {
  return {t.x, {-t.y[0], -t.y[1]}, {t.offset[0] + t.y[0], t.offset[1] + t.y[1]}};
}

/// to_uv, or what version 0.6 had instead of it.
scene::UvTransform uv_transform(Properties& properties) {
  Transform to_uv = properties.transform("to_uv");
  if (properties.object().is_old) {
    const Vec3 offset(properties.number("uoffset", 0), properties.number("voffset", 0), 0);
    const Vec3 scale(properties.number("uscale", 1), properties.number("vscale", 1), 1);
    to_uv = Transform::scaling(scale) * Transform::translation(offset) * to_uv;
    properties.ignore({"gamma", "cache", "max_anisotropy", "channel"});
  }
  return in_plane(to_uv);
}

}  // namespace

scene::ColorInput TextureLibrary::color(Properties& properties, std::string_view name, const Spectrum& missing,
                                        SpectrumRole role, Use use) {
  const Element* element = properties.find(name);
  if (element == nullptr) return missing;
  if (is_constant_color(*element)) return read_spectrum(properties.document(), *element, role, properties.report());
  if (const auto id = texture(properties.document(), *element, use, properties.report())) return *id;
  return kUnknownTexture;
}

scene::FloatInput TextureLibrary::number(Properties& properties, std::string_view name, float missing) {
  const Element* element = properties.find(name);
  if (element == nullptr) return missing;
  if (element->tag == "float" || element->tag == "integer") return properties.number(name, missing);
  if (is_constant_color(*element))
    return read_spectrum(properties.document(), *element, SpectrumRole::unbounded, properties.report()).luminance();
  if (const auto id = texture(properties.document(), *element, Use::number, properties.report())) return *id;
  return kUnknownTexture.luminance();
}

Spectrum TextureLibrary::constant(Properties& properties, std::string_view name, const Spectrum& missing,
                                  SpectrumRole role) {
  const Element* element = properties.find(name);
  if (element == nullptr) return missing;
  if (is_constant_color(*element)) return read_spectrum(properties.document(), *element, role, properties.report());
  if (element->tag != "texture")
    throw Problem(fmt::format("{} of {} is a <{}>; it needs to be a colour", in_quotes(name),
                              in_quotes(properties.type()), element->tag),
                  element->where);
  properties.report().warning(
      fmt::format("{} of {} cannot be a texture here; it is left out", in_quotes(name), in_quotes(properties.type())),
      element->where);
  return missing;
}

std::optional<scene::Id<scene::Texture>> TextureLibrary::texture(const Document& document, const Element& element,
                                                                 Use use, Report& report) {
  const std::pair key{&element, use};
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  std::optional<scene::Id<scene::Texture>> id;
  if (auto texture = read(document, element, use, report)) {
    texture->where = element.where;
    if (use == Use::slide) texture->to_uv = after_turning_v(texture->to_uv);
    id = {static_cast<std::uint32_t>(scene_.textures.size())};
    scene_.textures.push_back(*std::move(texture));
  }
  known_[key] = id;
  return id;
}

std::optional<scene::Texture> TextureLibrary::read(const Document& document, const Element& element, Use use,
                                                   Report& report) {
  if (element.tag != "texture" && element.tag != "spectrum")
    throw Problem(fmt::format("a <{}> is neither a colour nor a texture", element.tag), element.where);
  Properties properties(document, element, report);
  std::optional<scene::Texture> texture;
  if (element.type() == "bitmap") {
    texture = read_bitmap(properties);
  } else if (element.type() == "checkerboard") {
    texture = read_checkerboard(properties, use);
  } else if (element.type() == "mesh_attribute") {
    texture = read_mesh_attribute(properties);
  } else if (element.type() == "volume") {
    texture = read_volume(properties);
  } else {
    report.warning(fmt::format("the texture {} is not known here; grey (0.5) is used", in_quotes(element.type())),
                   element.where);
    return std::nullopt;
  }
  properties.reject_unread();
  if (texture) texture->name = properties.name();
  return texture;
}

scene::Texture TextureLibrary::read_bitmap(Properties& properties) {
  scene::BitmapTexture bitmap;
  bitmap.file = properties.file("filename");
  const bool is_nearest = properties.object().is_old
                              ? properties.choice("filter_type", {"ewa", "trilinear", "nearest"}) == 2
                              : properties.choice("filter_type", {"bilinear", "nearest"}) == 1;
  bitmap.filter = is_nearest ? scene::TextureFilter::nearest : scene::TextureFilter::bilinear;
  constexpr scene::TextureWrap kWraps[] = {scene::TextureWrap::repeat, scene::TextureWrap::mirror,
                                           scene::TextureWrap::clamp};
  bitmap.wrap = kWraps[properties.choice("wrap_mode", {"repeat", "mirror", "clamp"})];
  bitmap.raw = properties.boolean("raw", false);
  properties.ignore({"accel", "format"});
  return {{}, bitmap, upside_down(uv_transform(properties)), {}};
}

scene::Texture TextureLibrary::read_checkerboard(Properties& properties, Use use) {
  scene::CheckerboardTexture board;
  board.color0 = reflectance(properties, "color0", 0.4f);
  board.color1 = reflectance(properties, "color1", 0.2f);
  if (use == Use::number) std::swap(board.color0, board.color1);  // where it stands for a number, Mitsuba takes them so
  return {{}, board, uv_transform(properties), {}};
}

scene::Texture TextureLibrary::read_mesh_attribute(Properties& properties) {
  const std::string attribute = properties.required_text("name");
  if (!attribute.starts_with("vertex_") && !attribute.starts_with("face_"))
    throw Problem(
        fmt::format("a mesh's attributes are called \"vertex_…\" or \"face_…\", not {}", in_quotes(attribute)),
        properties.find("name")->where);
  return {{}, scene::MeshAttributeTexture{attribute, properties.number("scale", 1)}, {}, {}};
}

std::optional<scene::Texture> TextureLibrary::read_volume(Properties& properties) {
  const Element* element = properties.object("volume");
  if (element == nullptr) throw Problem("the texture \"volume\" needs a <volume>", properties.where());
  const scene::VolumeInput input = volumes_.volume(properties.document(), *element, properties.report());
  if (const auto* id = std::get_if<scene::Id<scene::Volume>>(&input))
    return scene::Texture{{}, scene::VolumeTexture{*id}, {}, {}};
  const Spectrum color = std::get<Spectrum>(input);  // a checkerboard with one colour
  return scene::Texture{{}, scene::CheckerboardTexture{color, color}, {}, {}};
}

}  // namespace etendue::mitsuba
