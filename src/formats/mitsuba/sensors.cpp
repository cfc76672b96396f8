#include "formats/mitsuba/sensors.h"

#include <fmt/format.h>

#include <cmath>

#include "formats/mitsuba/fov.h"
#include "formats/mitsuba/transforms.h"

namespace etendue::mitsuba {
namespace {

constexpr int kMostPixels = 1 << 16;  ///< in a row or column

scene::ReconstructionFilter gaussian(float standard_deviation) {
  return {scene::FilterKind::gaussian, 4 * standard_deviation};
}

scene::ReconstructionFilter read_filter(const Document& document, const Element& element, Report& report) {
  Properties properties(document, element, report);
  const std::string_view type = element.type();
  scene::ReconstructionFilter filter;
  if (type == "box") {
    if (element.is_old) properties.ignore({"radius"});
  } else if (type == "tent") {
    filter = {scene::FilterKind::tent, properties.number("radius", 1, 1e-3f, 64)};
  } else if (type == "gaussian") {
    filter = gaussian(properties.number("stddev", 0.5f, 1e-3f, 16));
  } else if (type == "mitchell") {
    filter = {scene::FilterKind::mitchell, 2, properties.number("B", 1.0f / 3), properties.number("C", 1.0f / 3)};
  } else if (type == "catmullrom") {
    filter = {scene::FilterKind::catmull_rom, 2};
  } else if (type == "lanczos") {
    filter = {scene::FilterKind::lanczos, static_cast<float>(properties.integer("lobes", 3, 1, 64))};
  } else {
    report.warning(fmt::format("the filter {} is not known here; gaussian is used", in_quotes(type)), element.where);
    return gaussian(0.5f);
  }
  properties.reject_unread();
  return filter;
}

scene::Film default_film() {
  return {768, 576, {}, gaussian(0.5f)};
}

scene::Film read_film(const Document& document, const Element& element, Report& report) {
  const std::string_view type = element.type();
  if (type != "hdrfilm" && type != "ldrfilm")
    report.warning(fmt::format("the film {} is not known here; it is read as \"hdrfilm\"", in_quotes(type)),
                   element.where);
  Properties properties(document, element, report);
  scene::Film film = default_film();
  film.width = properties.integer("width", film.width, 1, kMostPixels);
  film.height = properties.integer("height", film.height, 1, kMostPixels);
  const int x = properties.integer("crop_offset_x", 0, 0, film.width - 1);
  const int y = properties.integer("crop_offset_y", 0, 0, film.height - 1);
  const int width = properties.integer("crop_width", film.width, 1, kMostPixels);
  const int height = properties.integer("crop_height", film.height, 1, kMostPixels);
  if (x + width > film.width || y + height > film.height)
    throw Problem(fmt::format("the crop window ({}, {}) + ({}, {}) reaches beyond the film's {} × {} pixels", x, y,
                              width, height, film.width, film.height),
                  element.where);
  if (width != film.width || height != film.height) film.crop = {x, y, width, height};
  if (const Element* filter = properties.object("rfilter")) film.filter = read_filter(document, *filter, report);
  properties.ignore({"banner", "compensate", "component_format", "file_format", "pixel_format", "sample_border"});
  if (element.is_old)
    properties.ignore({"attach_log", "channel_names", "exposure", "gamma", "high_quality_edges", "key", "burn", "label",
                       "tonemap_method", "variable"});
  if (type == "hdrfilm" || type == "ldrfilm") properties.reject_unread();
  return film;
}

std::optional<int> read_sample_count(const Document& document, const Element& element, Report& report) {
  Properties properties(document, element, report);
  const int count = properties.integer("sample_count", 4, 1, 1 << 30);
  properties.ignore({"seed", "jitter", "dimension", "scramble"});
  if (element.is_old) properties.ignore({"max_dimension", "dimensions"});
  properties.reject_unread();
  return count;
}

/// A camera's frame has no business with scale; lengths it measures would change with it.
Transform without_scale(const Transform& t, Properties& properties) {
  const auto is_unit = [](const Vec3& v) { return std::abs(length_squared(v) - 1) < 1e-3f; };
  if (is_unit(t.x) && is_unit(t.y) && is_unit(t.z)) return t;
  if (!(std::abs(t.determinant()) > 0))
    throw Problem("the sensor's to_world makes everything flat", properties.where());
  properties.report().warning("the sensor's to_world has a scale; the scale is ignored", properties.where());
  return {normalize(t.x), normalize(t.y), normalize(t.z), t.origin};
}

void read_clipping(Properties& properties, scene::Camera& camera) {
  camera.near_clip = properties.number("near_clip", 1e-2f, 1e-30f, 3e38f);
  camera.far_clip = properties.number("far_clip", 1e4f, 1e-30f, 3e38f);
  if (!(camera.near_clip < camera.far_clip))
    throw Problem("\"near_clip\" needs to be below \"far_clip\"", properties.where());
}

void read_perspective(Properties& properties, scene::Camera& camera) {
  read_clipping(properties, camera);
  camera.to_world = facing_backwards(without_scale(properties.transform("to_world"), properties));
  camera.xfov_deg = read_horizontal_fov(properties, camera.aspect);
  camera.principal_point = {properties.number("principal_point_offset_x", 0),
                            properties.number("principal_point_offset_y", 0)};
  properties.ignore({"focus_distance"});
}

void read_thin_lens(Properties& properties, scene::Camera& camera) {
  read_clipping(properties, camera);
  camera.to_world = facing_backwards(without_scale(properties.transform("to_world"), properties));
  camera.xfov_deg = read_horizontal_fov(properties, camera.aspect);
  if (!properties.has("aperture_radius"))
    throw Problem("\"thinlens\" needs an \"aperture_radius\"", properties.where());
  camera.lens_radius = properties.number("aperture_radius", 0, 0, 3e38f);
  camera.focal_distance = properties.number("focus_distance", camera.far_clip, 1e-30f, 3e38f);
}

/// The distance of the near plane is scaled like the picture; the reach from there on is in metres.
void read_orthographic(Properties& properties, scene::Camera& camera) {
  read_clipping(properties, camera);
  const float reach = camera.far_clip - camera.near_clip;
  camera.projection = scene::Projection::orthographic;
  camera.to_world = facing_backwards(properties.transform("to_world"));
  camera.near_clip *= length(camera.to_world.z);
  camera.far_clip = camera.near_clip + reach;
  properties.ignore({"focus_distance"});
}

void read_radiance_meter(Properties& properties, scene::Camera& camera) {
  camera.projection = scene::Projection::radiance;
  Transform to_world = properties.transform("to_world");
  const auto origin = properties.vector("origin"), direction = properties.vector("direction");
  if (!properties.has("to_world")) {
    if (origin.has_value() != direction.has_value())
      throw Problem("\"radiancemeter\" needs both \"origin\" and \"direction\", or a \"to_world\"", properties.where());
    if (direction) {
      if (!(length_squared(*direction) > 0)) throw Problem("the \"direction\" has no length", properties.where());
      to_world = look_at(*origin, *origin + normalize(*direction), any_up(normalize(*direction)));
    }
  }
  camera.to_world = facing_backwards(to_world);
}

}  // namespace

std::optional<Sensor> read_sensor(const Document& document, const Element& element, MediumLibrary& media,
                                  Report& report) {
  Properties properties(document, element, report);
  Sensor sensor;
  scene::Camera& camera = sensor.camera;
  camera.name = properties.name();
  camera.where = element.where;
  const Element* film = properties.object("film");
  camera.film = film == nullptr ? default_film() : read_film(document, *film, report);
  camera.aspect = static_cast<float>(camera.film.width) / static_cast<float>(camera.film.height);

  const std::string_view type = element.type();
  if (type == "perspective") {
    read_perspective(properties, camera);
  } else if (type == "thinlens") {
    read_thin_lens(properties, camera);
  } else if (type == "orthographic") {
    read_orthographic(properties, camera);
  } else if (type == "radiancemeter") {
    read_radiance_meter(properties, camera);
  } else if (type == "irradiancemeter") {
    camera.projection = scene::Projection::irradiance;
  } else {
    report.warning(fmt::format("the sensor {} is not known here; it is left out", in_quotes(type)), element.where);
    return std::nullopt;
  }
  if (const Element* sampler = properties.object("sampler"))
    sensor.samples_per_pixel = read_sample_count(document, *sampler, report);
  camera.medium = media.only(properties);
  properties.ignore({"shutter_open", "shutter_close", "srf"});
  properties.reject_unread();
  return sensor;
}

}  // namespace etendue::mitsuba
