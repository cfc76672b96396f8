#include "formats/mitsuba/writer/textures.h"

#include <filesystem>

#include "formats/volume_file.h"

namespace etendue::mitsuba {
namespace {

using Use = TextureWriter::Use;

/// Mitsuba's v = 0 is a picture's top row, ours the bottom one: the same transform followed by v ↦ 1 − v.
scene::UvTransform upside_down(const scene::UvTransform& t) {
  return {{t.x[0], -t.x[1]}, {t.y[0], -t.y[1]}, {t.offset[0], 1 - t.offset[1]}};
}

/// (u, v) ↦ (u, 1 − v), then `t`: the pictures that lamps throw have their v from the other end.
scene::UvTransform after_turning_v(const scene::UvTransform& t) {
  return {t.x, {-t.y[0], -t.y[1]}, {t.offset[0] + t.y[0], t.offset[1] + t.y[1]}};
}

void add_uv_transform(pugi::xml_node parent, const scene::UvTransform& t) {
  add_transform(parent, "to_uv", {{t.x[0], t.x[1], 0}, {t.y[0], t.y[1], 0}, {0, 0, 1}, {t.offset[0], t.offset[1], 0}});
}

const char* word(scene::TextureWrap wrap) {
  switch (wrap) {
    case scene::TextureWrap::repeat:
      return "repeat";
    case scene::TextureWrap::mirror:
      return "mirror";
    case scene::TextureWrap::clamp:
      break;
  }
  return "clamp";
}

}  // namespace

void TextureWriter::add(pugi::xml_node parent, const std::string& name, const scene::ColorInput& input) {
  if (const auto* texture = std::get_if<scene::Id<scene::Texture>>(&input))
    add(parent, name, *texture, Use::color);
  else
    add_reflectance(parent, name, std::get<Spectrum>(input));
}

void TextureWriter::add_emission(pugi::xml_node parent, const std::string& name, const scene::ColorInput& input,
                                 Use use) {
  if (const auto* texture = std::get_if<scene::Id<scene::Texture>>(&input))
    add(parent, name, *texture, use);
  else
    add_color(parent, name, std::get<Spectrum>(input));
}

void TextureWriter::add(pugi::xml_node parent, const std::string& name, const scene::FloatInput& input) {
  if (const auto* texture = std::get_if<scene::Id<scene::Texture>>(&input))
    add(parent, name, *texture, Use::number);
  else
    add_number(parent, name, std::get<float>(input));
}

void TextureWriter::add(pugi::xml_node parent, const std::string& name, const scene::VolumeInput& input) {
  if (const auto* volume = std::get_if<scene::Id<scene::Volume>>(&input))
    add_reference(parent, name, id(*volume));
  else
    add_color(parent, name, std::get<Spectrum>(input));
}

void TextureWriter::add(pugi::xml_node parent, const std::string& name, scene::Id<scene::Texture> texture, Use use) {
  add_reference(parent, name, id(texture, use));
}

const std::string& TextureWriter::id(scene::Id<scene::Texture> id, Use use) {
  const scene::Texture& texture = context_.scene.textures[id.index];
  const bool is_board = std::holds_alternative<scene::CheckerboardTexture>(texture.source);
  if (use == Use::number && !is_board) use = Use::color;  // they are the same
  const auto [place, is_new] = textures_.try_emplace({id.index, use});
  if (is_new) {
    place->second = context_.ids.unique(texture.name, "texture");
    std::visit([&, &name = place->second](const auto& source) { write(source, texture, use, name); }, texture.source);
  }
  return place->second;
}

void TextureWriter::write(const scene::BitmapTexture& bitmap, const scene::Texture& texture, Use use,
                          const std::string& id) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(bitmap.file, failure)) {
    context_.written_instead("a picture is not there; grey is written", texture.where);
    return write(scene::CheckerboardTexture{Spectrum(0.5f), Spectrum(0.5f)}, {}, use, id);
  }
  pugi::xml_node node = add_object(elements_, "texture", "bitmap", id);
  add_text(node, "filename", context_.files.elsewhere(bitmap.file));
  if (bitmap.filter == scene::TextureFilter::nearest) add_text(node, "filter_type", "nearest");
  if (bitmap.wrap != scene::TextureWrap::repeat) add_text(node, "wrap_mode", word(bitmap.wrap));
  add_flag(node, "raw", bitmap.raw);
  add_uv_transform(node, upside_down(use == Use::slide ? after_turning_v(texture.to_uv) : texture.to_uv));
}

void TextureWriter::write(const scene::CheckerboardTexture& board, const scene::Texture& texture, Use use,
                          const std::string& id) {
  pugi::xml_node node = add_object(elements_, "texture", "checkerboard", id);
  const bool swapped =
      use == Use::number;  // where it stands for a number, Mitsuba takes the colours the other way round
  add(node, "color0", swapped ? board.color1 : board.color0);
  add(node, "color1", swapped ? board.color0 : board.color1);
  add_uv_transform(node, use == Use::slide ? after_turning_v(texture.to_uv) : texture.to_uv);
}

void TextureWriter::write(const scene::MeshAttributeTexture& attribute, const scene::Texture&, Use,
                          const std::string& id) {
  pugi::xml_node node = add_object(elements_, "texture", "mesh_attribute", id);
  add_text(node, "name", attribute.attribute);
  if (attribute.scale != 1) add_number(node, "scale", attribute.scale);
}

void TextureWriter::write(const scene::VolumeTexture& source, const scene::Texture&, Use, const std::string& id) {
  pugi::xml_node node = add_object(elements_, "texture", "volume", id);
  add_reference(node, "volume", this->id(source.volume));
}

const std::string& TextureWriter::id(scene::Id<scene::Volume> id) {
  const auto [place, is_new] = volumes_.try_emplace(id.index);
  if (is_new) {
    const scene::Volume& volume = context_.scene.volumes[id.index];
    place->second = context_.ids.unique(volume.name, "volume");
    pugi::xml_node node = add_object(elements_, "volume", "gridvolume", place->second);
    std::visit([&](const auto& source) { write(source, volume, node); }, volume.source);
    add_transform(node, "to_world", volume.to_world);
  }
  return place->second;
}

void TextureWriter::write(const scene::GridVolume& grid, const scene::Volume& volume, pugi::xml_node node) {
  add_text(node, "filename",
           context_.files.add(volume.name.empty() ? "volume" : volume.name, ".vol", volume_file_bytes(grid)));
  if (grid.filter == scene::TextureFilter::nearest) add_text(node, "filter_type", "nearest");
  if (grid.wrap != scene::TextureWrap::clamp) add_text(node, "wrap_mode", word(grid.wrap));
}

void TextureWriter::write(const scene::VdbVolume& file, const scene::Volume& volume, pugi::xml_node node) {
  context_.written_instead("Mitsuba reads no OpenVDB files; the volume refers to one all the same", volume.where);
  add_text(node, "filename", context_.files.elsewhere(file.file));
  if (!file.grid.empty()) add_text(node, "grid", file.grid);
}

}  // namespace etendue::mitsuba
