#include "formats/mitsuba/writer/camera.h"

#include <cmath>

#include "formats/mitsuba/transforms.h"

namespace etendue::mitsuba {
namespace {

/// What stands for "no limit", in metres.
constexpr float kNearest = 1e-6f, kFarthest = 1e9f;

void add_filter(pugi::xml_node film, const scene::ReconstructionFilter& filter) {
  const auto add = [&](const char* type) { return add_object(film, "rfilter", type); };
  switch (filter.kind) {
    case scene::FilterKind::box:
      add("box");
      break;
    case scene::FilterKind::tent:
      add_number(add("tent"), "radius", filter.radius);
      break;
    case scene::FilterKind::gaussian:
      add_number(add("gaussian"), "stddev", filter.radius / 4);
      break;
    case scene::FilterKind::mitchell: {
      const pugi::xml_node node = add("mitchell");
      add_number(node, "B", filter.b);
      add_number(node, "C", filter.c);
      break;
    }
    case scene::FilterKind::catmull_rom:
      add("catmullrom");
      break;
    case scene::FilterKind::lanczos:
      add_integer(add("lanczos"), "lobes", static_cast<int>(filter.radius));
      break;
  }
}

void add_film(pugi::xml_node sensor, const scene::Film& film) {
  const pugi::xml_node node = add_object(sensor, "film", "hdrfilm");
  if (film.width > 0 && film.height > 0) {
    add_integer(node, "width", film.width);
    add_integer(node, "height", film.height);
  }
  if (film.crop) {
    constexpr const char* kNames[] = {"crop_offset_x", "crop_offset_y", "crop_width", "crop_height"};
    for (std::size_t i = 0; i < 4; ++i) add_integer(node, kNames[i], (*film.crop)[i]);
  }
  add_text(node, "pixel_format", "rgb");
  add_text(node, "component_format", "float32");
  if (film.filter) add_filter(node, *film.filter);
}

void add_clipping(pugi::xml_node sensor, float near_clip, float far_clip) {
  add_number(sensor, "near_clip", near_clip > 0 ? near_clip : kNearest);
  add_number(sensor, "far_clip", far_clip > 0 ? far_clip : kFarthest);
}

void add_perspective(pugi::xml_node sensor, const scene::Camera& camera) {
  add_clipping(sensor, camera.near_clip, camera.far_clip);
  add_number(sensor, "fov", camera.xfov_deg);
  add_text(sensor, "fov_axis", "x");
  if (camera.lens_radius > 0) {
    add_number(sensor, "aperture_radius", camera.lens_radius);
    if (camera.focal_distance > 0) add_number(sensor, "focus_distance", camera.focal_distance);
  }
  if (camera.principal_point != std::array<float, 2>{0, 0}) {
    add_number(sensor, "principal_point_offset_x", camera.principal_point[0]);
    add_number(sensor, "principal_point_offset_y", camera.principal_point[1]);
  }
}

/// The near plane's distance is scaled like the picture; the reach from there on is in metres.
void add_orthographic(pugi::xml_node sensor, const scene::Camera& camera) {
  const float near_clip = camera.near_clip / length(camera.to_world.z);
  const float far_clip = camera.far_clip > 0 ? near_clip + (camera.far_clip - camera.near_clip) : 0;
  add_clipping(sensor, near_clip, far_clip);
}

std::string sensor_type(const scene::Camera& camera) {
  switch (camera.projection) {
    case scene::Projection::perspective:
      return camera.lens_radius > 0 ? "thinlens" : "perspective";
    case scene::Projection::orthographic:
      return "orthographic";
    case scene::Projection::radiance:
      return "radiancemeter";
    case scene::Projection::irradiance:
      break;
  }
  return "irradiancemeter";
}

/// Only where the picture is as large as the camera does a scale say something.
Transform without_scale(const Transform& t) {
  const auto unit = [](const Vec3& v) { return std::abs(length_squared(v) - 1) < 1e-3f ? v : normalize(v); };
  return {unit(t.x), unit(t.y), unit(t.z), t.origin};
}

Transform observer_transform(const scene::Camera& camera) {
  const bool is_measured = camera.projection == scene::Projection::orthographic;
  Transform t = is_measured ? camera.to_world : without_scale(camera.to_world);
  if (camera.mirrored) t.x = -t.x;
  return facing_backwards(t);
}

}  // namespace

void add_camera(pugi::xml_node parent, const scene::Camera& camera, WriterContext& context, MediumWriter& media) {
  const std::string type = sensor_type(camera);
  pugi::xml_node node = add_object(parent, "sensor", type, context.ids.telling(camera.name, type));
  if (camera.projection == scene::Projection::perspective) add_perspective(node, camera);
  if (camera.projection == scene::Projection::orthographic) add_orthographic(node, camera);
  if (camera.projection != scene::Projection::irradiance) add_transform(node, "to_world", observer_transform(camera));
  media.add(node, {}, camera.medium);
  if (context.scene.hints.samples_per_pixel)
    add_integer(add_object(node, "sampler", "independent"), "sample_count", *context.scene.hints.samples_per_pixel);
  add_film(node, camera.film);
}

}  // namespace etendue::mitsuba
