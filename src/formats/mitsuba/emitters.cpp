#include "formats/mitsuba/emitters.h"

#include <fmt/format.h>

#include "base/error.h"
#include "formats/mitsuba/fov.h"
#include "formats/mitsuba/transforms.h"
#include "image/texels.h"

namespace etendue::mitsuba {
namespace {

/// Mitsuba's projector sends π times its "irradiance" into the world.
constexpr float kProjectorFactor = kPi;

Spectrum emission(Properties& properties, TextureLibrary& textures, std::string_view name) {
  return textures.constant(properties, name, Spectrum(1), SpectrumRole::emission);
}

[[noreturn]] void reject_both(Properties& properties, std::string_view name) {
  throw Problem(
      fmt::format("{} has both \"{}\" and \"to_world\"; one of them is enough", in_quotes(properties.type()), name),
      properties.where());
}

scene::Light read_point(Properties& properties, TextureLibrary& textures) {
  if (properties.has("position") && properties.has("to_world")) reject_both(properties, "position");
  const Vec3 position = properties.vector("position", properties.transform("to_world").origin);
  return {{}, scene::PointLight{emission(properties, textures, "intensity")}, Transform::translation(position), {}};
}

/// Turned half around its axis, the frame of Mitsuba's lamp has its textures upright: the picture's u grows along +x,
/// its v (downwards there) along +y.
Transform facing_backwards_turned(const Transform& t) {
  return {t.x, -t.y, -t.z, t.origin};
}

scene::Light read_spot(Properties& properties, TextureLibrary& textures) {
  scene::SpotLight spot;
  spot.intensity = emission(properties, textures, "intensity");
  spot.cutoff_deg = properties.number("cutoff_angle", 20, 0.001f, 179);
  spot.beam_deg = properties.number("beam_width", spot.cutoff_deg * 0.75f, 0, spot.cutoff_deg);
  if (const Element* texture = properties.find("texture")) {
    if (is_constant_color(*texture))
      throw Problem("\"texture\" of \"spot\" needs a picture; a colour belongs into its \"intensity\"", texture->where);
    spot.texture = textures.texture(properties.document(), *texture, TextureLibrary::Use::slide, properties.report());
  }
  return {{}, spot, facing_backwards_turned(properties.transform("to_world")), {}};
}

scene::Light read_directional(Properties& properties, TextureLibrary& textures) {
  Transform to_world = properties.transform("to_world");
  if (properties.has("direction")) {
    if (properties.has("to_world")) reject_both(properties, "direction");
    const Vec3 direction = *properties.vector("direction");
    if (!(length_squared(direction) > 0))
      throw Problem("the \"direction\" has no length", properties.find("direction")->where);
    const Vec3 forward = normalize(direction);
    to_world = look_at(Point3(0), forward, any_up(forward));
  }
  return {{}, scene::DirectionalLight{emission(properties, textures, "irradiance")}, facing_backwards(to_world), {}};
}

scene::Light read_constant(Properties& properties, TextureLibrary& textures) {
  properties.ignore({"to_world"});
  return {{}, scene::ConstantLight{emission(properties, textures, "radiance")}, {}, {}};
}

scene::Light read_environment(Properties& properties) {
  scene::EnvironmentLight environment;
  environment.file = properties.file("filename");
  environment.intensity = properties.number("scale", 1, 0, 3e38f);
  properties.ignore({"mis_compensation"});
  return {{}, environment, properties.transform("to_world"), {}};
}

/// Width over height of what a projector shows; 1 if it is no picture, or cannot be read: that is told when it is
/// looked up.
float picture_aspect(const scene::ColorInput& input, const scene::SceneDescription& scene) {
  const auto* id = std::get_if<scene::Id<scene::Texture>>(&input);
  const auto* bitmap = id == nullptr ? nullptr : std::get_if<scene::BitmapTexture>(&scene.textures[id->index].source);
  if (bitmap == nullptr) return 1;
  try {
    const Texels texels = read_texels(bitmap->file, ColorEncoding::linear);
    return static_cast<float>(texels.width()) / static_cast<float>(texels.height());
  } catch (const Error&) {
    return 1;
  }
}

scene::Light read_projector(Properties& properties, TextureLibrary& textures) {
  scene::ProjectorLight projector;
  projector.irradiance =
      textures.color(properties, "irradiance", Spectrum(1), SpectrumRole::emission, TextureLibrary::Use::slide);
  projector.scale = kProjectorFactor * properties.number("scale", 1, 0, 3e38f);
  projector.aspect = picture_aspect(projector.irradiance, textures.scene());
  projector.xfov_deg = read_horizontal_fov(properties, projector.aspect);
  return {{}, projector, facing_backwards(properties.transform("to_world")), {}};
}

}  // namespace

std::optional<scene::Light> read_emitter(const Document& document, const Element& element, TextureLibrary& textures,
                                         Report& report) {
  Properties properties(document, element, report);
  const std::string_view type = element.type();
  scene::Light light;
  if (type == "point") {
    light = read_point(properties, textures);
  } else if (type == "spot") {
    light = read_spot(properties, textures);
  } else if (type == "directional") {
    light = read_directional(properties, textures);
  } else if (type == "constant") {
    light = read_constant(properties, textures);
  } else if (type == "envmap") {
    light = read_environment(properties);
  } else if (type == "projector") {
    light = read_projector(properties, textures);
  } else if (type == "area") {
    throw Problem("an \"area\" emitter stands within the <shape> that shines", element.where);
  } else {
    report.warning(fmt::format("the emitter {} is not known here; it is left out", in_quotes(type)), element.where);
    return std::nullopt;
  }
  properties.ignore({"sampling_weight"});
  properties.objects("medium");  // light knows the media from the surfaces that it passes
  properties.reject_unread();
  light.name = properties.name();
  light.where = element.where;
  return light;
}

std::optional<scene::ColorInput> read_area_emitter(const Document& document, const Element& element,
                                                   TextureLibrary& textures, Report& report) {
  if (element.type() != "area") {
    report.warning(
        fmt::format("the emitter {} of a shape is not known here; it is left out", in_quotes(element.type())),
        element.where);
    return std::nullopt;
  }
  Properties properties(document, element, report);
  const scene::ColorInput radiance = textures.color(properties, "radiance", Spectrum(1), SpectrumRole::emission);
  properties.ignore({"sampling_weight"});
  properties.objects("medium");
  properties.reject_unread();
  return radiance;
}

}  // namespace etendue::mitsuba
