#include "formats/mitsuba/writer/lights.h"

#include "formats/mitsuba/transforms.h"
#include "formats/mitsuba/writer/sky_pictures.h"
#include "image/io.h"

namespace etendue::mitsuba {
namespace {

/// Beyond this half angle a spot's picture would be nearly all edge.
constexpr float kWidestPictureDeg = 80;

class LightWriter {
 public:
  LightWriter(pugi::xml_node parent, const scene::Light& light, WriterContext& context, TextureWriter& textures,
              ShapeWriter& shapes)
      : parent_(parent), light_(light), context_(context), textures_(textures), shapes_(shapes) {}

  void operator()(const scene::PointLight& l) const {
    const pugi::xml_node node = add("point");
    add_point(node, "position", light_.to_world.origin);
    add_color(node, "intensity", l.intensity);
  }

  /// Turned half around its axis, the frame of Mitsuba's lamp has its textures upright.
  void operator()(const scene::SpotLight& l) const {
    const pugi::xml_node node = add("spot");
    const Transform& t = light_.to_world;
    add_transform(node, "to_world", {t.x, -t.y, -t.z, t.origin});
    add_color(node, "intensity", l.intensity);
    add_number(node, "cutoff_angle", l.cutoff_deg);
    add_number(node, "beam_width", l.beam_deg.value_or(l.cutoff_deg));
    if (l.falloff_exponent != 0) add_falloff(node, l);
    if (l.texture) textures_.add(node, "texture", *l.texture, TextureWriter::Use::slide);
  }

  void operator()(const scene::DirectionalLight& l) const {
    const pugi::xml_node node = add("directional");
    add_transform(node, "to_world", facing_backwards(light_.to_world));
    add_color(node, "irradiance", l.irradiance);
  }

  void operator()(const scene::RectangleLight& l) const { shapes_.add(parent_, light_, l); }

  void operator()(const scene::HemisphereLight& l) const {
    const pugi::xml_node node = add("envmap");
    context_.written_instead(
        "a light from above the horizon is written as a picture of it, whose edge is blurred over 0.2 degrees",
        light_.where);
    add_text(
        node, "filename",
        context_.files.add_picture(light_.name.empty() ? "hemisphere" : light_.name, upper_half_picture(l.radiance)));
  }

  /// Turning a map about +y counter-clockwise, seen from above, is what turning its frame does. Read from right to left
  /// its middle lies elsewhere by a quarter.
  void operator()(const scene::EnvironmentLight& l) const {
    const pugi::xml_node node = add("envmap");
    const std::string file = l.mirrored
                                 ? context_.files.add_picture(l.file.stem().string(), mirrored_map(read_image(l.file)))
                                 : context_.files.elsewhere(l.file);
    const float turn_deg = l.rotation_deg + (l.mirrored ? 90.0f : 0.0f);
    const Transform& t = light_.to_world;
    add_text(node, "filename", file);
    add_transform(node, "to_world", turn_deg == 0 ? t : t * Transform::rotation({0, 1, 0}, radians(turn_deg)));
    add_number(node, "scale", l.intensity);
  }

  /// Mitsuba's projector sends π times its "irradiance" into the world.
  void operator()(const scene::ProjectorLight& l) const {
    const pugi::xml_node node = add("projector");
    add_transform(node, "to_world", facing_backwards(light_.to_world));
    textures_.add_emission(node, "irradiance", l.irradiance, TextureWriter::Use::slide);
    add_number(node, "scale", l.scale / kPi);
    add_number(node, "fov", l.xfov_deg);
    add_text(node, "fov_axis", "x");
  }

  void operator()(const scene::ConstantLight& l) const { add_color(add("constant"), "radiance", l.radiance); }

 private:
  pugi::xml_node add(const char* type) const {
    return add_object(parent_, "emitter", type, context_.ids.telling(light_.name, type));
  }

  void add_falloff(pugi::xml_node node, const scene::SpotLight& l) const {
    if (l.texture || l.cutoff_deg > kWidestPictureDeg) {
      context_.written_instead("the falloff of a spot that has a picture, or is wider than 80 degrees, is left out",
                               light_.where);
      return;
    }
    context_.written_instead("a spot's falloff with a power of the cosine is written as a picture of it", light_.where);
    pugi::xml_node picture = add_object(node, "texture", "bitmap");
    picture.append_attribute("name") = "texture";
    const Image falloff = falloff_picture(l.cutoff_deg, l.falloff_exponent);
    add_text(picture, "filename", context_.files.add_picture(light_.name.empty() ? "spot" : light_.name, falloff));
    add_text(picture, "wrap_mode", "clamp");
    add_flag(picture, "raw", true);
  }

  pugi::xml_node parent_;
  const scene::Light& light_;
  WriterContext& context_;
  TextureWriter& textures_;
  ShapeWriter& shapes_;
};

}  // namespace

void add_light(pugi::xml_node parent, const scene::Light& light, WriterContext& context, TextureWriter& textures,
               ShapeWriter& shapes) {
  std::visit(LightWriter(parent, light, context, textures, shapes), light.source);
}

bool surrounds(const scene::Light& light) {
  return std::holds_alternative<scene::HemisphereLight>(light.source) ||
         std::holds_alternative<scene::EnvironmentLight>(light.source) ||
         std::holds_alternative<scene::ConstantLight>(light.source);
}

}  // namespace etendue::mitsuba
