#include "formats/collada/lights_cameras.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/collada/numbers.h"

namespace etendue::collada {
namespace {

bool is_light_kind(std::string_view name) {
  return name == "area" || name == "ambient" || name == "directional" || name == "point" || name == "spot";
}

pugi::xml_node light_kind(pugi::xml_node technique) {
  return technique.find_child([](pugi::xml_node child) { return is_light_kind(child.name()); });
}

Spectrum light_color(const Document& document, Report& report, pugi::xml_node kind) {
  const pugi::xml_node element = kind.child("color");
  if (!element) throw Problem(fmt::format("<{}> needs a <color>", kind.name()), document.locate(kind));
  const std::vector<float> v = read_numbers(document, element, 3, 4);
  const Spectrum c(v[0], v[1], v[2]);
  if (!is_finite(c)) throw Problem("the colour of a light is not finite", document.locate(element));
  const Spectrum positive(std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f));
  if (!(c == positive)) report.repaired("a light has a negative colour; 0 is used", document.locate(element));
  return positive;
}

float number_or(const Document& document, pugi::xml_node parent, const char* name, float missing) {
  const pugi::xml_node element = parent.child(name);
  return element ? read_number(document, element) : missing;
}

/// COLLADA's falloff_angle is the whole angle of the cone.
scene::SpotLight read_spot(const Document& document, Report& report, pugi::xml_node kind, const Spectrum& intensity) {
  scene::SpotLight spot{intensity, number_or(document, kind, "falloff_angle", 180) / 2,
                        number_or(document, kind, "falloff_exponent", 0)};
  if (!(spot.cutoff_deg > 0 && spot.cutoff_deg <= 90)) {
    report.repaired("a spot light's falloff_angle is not between 0 and 180 degrees; 180 is used",
                    document.locate(kind));
    spot.cutoff_deg = 90;
  }
  if (!(spot.falloff_exponent >= 0) || !std::isfinite(spot.falloff_exponent)) {
    report.repaired("a spot light's falloff_exponent is not a number from 0 on; 0 is used", document.locate(kind));
    spot.falloff_exponent = 0;
  }
  return spot;
}

void tell_about_attenuation(const Document& document, Report& report, pugi::xml_node kind) {
  const bool is_given =
      kind.child("constant_attenuation") || kind.child("linear_attenuation") || kind.child("quadratic_attenuation");
  if (!is_given) return;
  const bool is_physical = number_or(document, kind, "constant_attenuation", 0) == 0 &&
                           number_or(document, kind, "linear_attenuation", 0) == 0 &&
                           number_or(document, kind, "quadratic_attenuation", 1) == 1;
  if (!is_physical)
    report.info_once("attenuation coefficients of lights are ignored: light falls off with the square of the distance",
                     document.locate(kind));
}

std::optional<float> field_of_view(const Document& document, Report& report, pugi::xml_node perspective,
                                   const char* name) {
  const pugi::xml_node element = perspective.child(name);
  if (!element) return std::nullopt;
  const float angle = read_number(document, element);
  if (angle > 0 && angle < 180) return angle;
  report.warning(fmt::format("the camera's <{}> is not between 0 and 180 degrees; it is ignored", name),
                 document.locate(element));
  return std::nullopt;
}

/// Full angle whose half has the tangent of half of `angle_deg` times `factor`.
float scaled_angle(float angle_deg, float factor) {
  return 2 * degrees(std::atan(factor * std::tan(radians(angle_deg / 2))));
}

void read_perspective(const Document& document, Report& report, pugi::xml_node perspective, scene::Camera& camera) {
  const auto xfov = field_of_view(document, report, perspective, "xfov");
  const auto yfov = field_of_view(document, report, perspective, "yfov");
  const float aspect = number_or(document, perspective, "aspect_ratio", 0);
  if (aspect > 0 && std::isfinite(aspect))
    camera.aspect = aspect;
  else if (xfov && yfov)
    camera.aspect = std::tan(radians(*xfov / 2)) / std::tan(radians(*yfov / 2));
  if (xfov)
    camera.xfov_deg = *xfov;
  else if (yfov)
    camera.xfov_deg = scaled_angle(*yfov, camera.aspect);
  else
    report.warning(fmt::format("the camera has neither xfov nor yfov; {} degrees across are used", camera.xfov_deg),
                   document.locate(perspective));
}

float clip_distance(const Document& document, pugi::xml_node optics, const char* name) {
  const float distance = number_or(document, optics, name, 0);
  return distance > 0 && std::isfinite(distance) ? distance : 0;
}

}  // namespace

std::optional<scene::LightSource> read_light(const Document& document, Report& report, pugi::xml_node light) {
  const pugi::xml_node cgl_kind = light_kind(cgl_technique(light));
  const pugi::xml_node kind = cgl_kind ? cgl_kind : light_kind(light.child("technique_common"));
  if (!kind)
    throw Problem(fmt::format("the light {} is of no kind known here; it is left out", in_quotes(name_of(light))),
                  document.locate(light));
  const Spectrum color = light_color(document, report, kind);
  if (color.is_black()) return std::nullopt;

  const std::string_view name = kind.name();
  if (name == "area") return scene::RectangleLight{color};
  if (name == "ambient") return scene::HemisphereLight{color};
  if (name == "directional") return scene::DirectionalLight{color};
  tell_about_attenuation(document, report, kind);
  if (name == "point") return scene::PointLight{color};
  return read_spot(document, report, kind, color);
}

scene::Camera read_camera(const Document& document, Report& report, pugi::xml_node element) {
  scene::Camera camera;
  camera.name = name_of(element);
  camera.where = document.locate(element);
  const pugi::xml_node technique = element.child("optics").child("technique_common");
  pugi::xml_node optics = technique.child("perspective");
  if (optics) {
    read_perspective(document, report, optics, camera);
  } else if ((optics = technique.child("orthographic"))) {
    report.warning(fmt::format("the camera {} is orthographic; a perspective of {} degrees takes its place",
                               in_quotes(camera.name), camera.xfov_deg),
                   camera.where);
  } else {
    throw Problem(fmt::format("the camera {} has no <optics>; it is left out", in_quotes(camera.name)), camera.where);
  }
  camera.near_clip = clip_distance(document, optics, "znear");
  camera.far_clip = clip_distance(document, optics, "zfar");
  return camera;
}

}  // namespace etendue::collada
