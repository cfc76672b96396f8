#include "formats/mitsuba/scene_reader.h"

#include "formats/mitsuba/emitters.h"
#include "formats/mitsuba/integrators.h"
#include "formats/mitsuba/shapes.h"

namespace etendue::mitsuba {
namespace {

/// Reads a scene's parts in the order of the file, and goes on after errors.
class SceneReader {
 public:
  SceneReader(const Document& document, Report& report)
      : document_(document),
        report_(report),
        volumes_(scene_),
        textures_(scene_, volumes_),
        materials_(scene_, textures_),
        media_(scene_, volumes_),
        shapes_(document, scene_, textures_, materials_, media_, report) {}

  scene::SceneDescription read();

 private:
  void read_integrators(Properties& properties);
  void add_sensor(std::optional<Sensor> sensor);
  void leave_out_media();

  template <typename Function>
  void each(Properties& properties, std::string_view tag, Function function) {
    for (const Element* element : properties.objects(tag)) try {
        function(*element);
      } catch (const Problem& problem) {
        report_.error(problem);
      }
  }

  const Document& document_;
  Report& report_;
  scene::SceneDescription scene_;
  VolumeLibrary volumes_;
  TextureLibrary textures_;
  MaterialLibrary materials_;
  MediumLibrary media_;
  ShapeReader shapes_;
  const Element* blind_ = nullptr;  ///< the integrator, if it sees no media
};

scene::SceneDescription SceneReader::read() {
  Properties properties(document_, document_.scene(), report_);
  read_integrators(properties);
  each(properties, "sensor", [&](const Element& e) { add_sensor(read_sensor(document_, e, media_, report_)); });
  each(properties, "emitter", [&](const Element& e) {
    if (auto light = read_emitter(document_, e, textures_, report_)) scene_.lights.push_back(*std::move(light));
  });
  each(properties, "shape", [&](const Element& e) { add_sensor(shapes_.place(e)); });
  for (const std::string_view tag :
       {"bsdf", "film", "medium", "phase", "rfilter", "sampler", "spectrum", "texture", "volume"})
    properties.objects(tag);  // read by those that refer to them
  properties.reject_unread();
  if (blind_ != nullptr && !scene_.media.empty()) leave_out_media();
  return std::move(scene_);
}

void SceneReader::read_integrators(Properties& properties) {
  const std::vector<const Element*> all = properties.objects("integrator");
  if (all.empty()) return;
  if (all.size() > 1) report_.warning("there is more than one integrator; the first is used", all[1]->where);
  try {
    const auto samples = scene_.hints.samples_per_pixel;
    const Integrator integrator = read_integrator(document_, *all.front(), report_);
    scene_.hints = integrator.hints;
    if (!integrator.sees_media) blind_ = all.front();
    scene_.hints.samples_per_pixel = samples;
  } catch (const Problem& problem) {
    report_.error(problem);
  }
}

void SceneReader::leave_out_media() {
  report_.warning("this integrator sees no media; they are left out (\"volpath\" sees them)", blind_->where);
  const auto leave = [](std::vector<scene::Instance>& instances) {
    for (scene::Instance& instance : instances) {
      instance.separates_media = false;
      instance.interior = instance.exterior = std::nullopt;
    }
  };
  leave(scene_.instances);
  for (scene::Group& group : scene_.groups) leave(group.instances);
  for (scene::Camera& camera : scene_.cameras) camera.medium = std::nullopt;
  scene_.media.clear();
}

/// The first camera's sampler counts.
void SceneReader::add_sensor(std::optional<Sensor> sensor) {
  if (!sensor) return;
  if (scene_.cameras.empty()) scene_.hints.samples_per_pixel = sensor->samples_per_pixel;
  scene_.cameras.push_back(std::move(sensor->camera));
}

}  // namespace

scene::SceneDescription read_scene(const Document& document, Report& report) {
  return SceneReader(document, report).read();
}

}  // namespace etendue::mitsuba
