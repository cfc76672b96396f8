#include "formats/mitsuba/writer/scene_writer.h"

#include <algorithm>
#include <sstream>

#include "formats/mitsuba/writer/camera.h"
#include "formats/mitsuba/writer/lights.h"
#include "formats/mitsuba/writer/shapes.h"

namespace etendue::mitsuba {
namespace {

/// Whether light can pass something that does not bend it, so that it matters how that counts.
bool has_what_lets_pass(const scene::SceneDescription& scene) {
  return !scene.media.empty() ||
         std::any_of(scene.materials.begin(), scene.materials.end(), [](const scene::Material& material) {
           return std::holds_alternative<scene::NullMaterial>(material.surface) ||
                  std::holds_alternative<scene::MaskMaterial>(material.surface) ||
                  std::holds_alternative<scene::ThinGlassMaterial>(material.surface);
         });
}

/// Mitsuba counts vertices, we bounces. Its "path" counts boundaries that do nothing, its "volpath" does not.
void add_integrator(pugi::xml_node parent, const scene::SceneDescription& scene) {
  const scene::RenderHints& hints = scene.hints;
  const bool counts_null = hints.null_counts_as_bounce || !has_what_lets_pass(scene);
  const pugi::xml_node node = add_object(parent, "integrator", counts_null ? "path" : "volpath");
  if (hints.max_depth) add_integer(node, "max_depth", *hints.max_depth + 1);
  add_flag(node, "hide_emitters", hints.hide_emitters);
}

void append_all(pugi::xml_node parent, const pugi::xml_document& elements) {
  for (const pugi::xml_node child : elements.children()) parent.append_copy(child);
}

class SceneWriter {
 public:
  SceneWriter(const scene::SceneDescription& scene, SideFiles& files, Diagnostics& diagnostics)
      : context_{scene, files, diagnostics},
        textures_(context_),
        materials_(context_, textures_),
        media_(context_, textures_),
        shapes_(context_, textures_, materials_, media_) {}

  std::string text() {
    add_sensor();
    add_lights();
    add_shapes();
    pugi::xml_document document;
    pugi::xml_node root = document.append_child("scene");
    root.append_attribute("version") = "3.0.0";
    add_integrator(root, context_.scene);
    append_all(root, sensors_);
    append_all(root, textures_.elements());
    append_all(root, materials_.elements());
    append_all(root, media_.elements());
    append_all(root, shapes_.groups());
    append_all(root, content_);
    std::ostringstream text;
    document.save(text, "  ", pugi::format_default, pugi::encoding_utf8);
    return text.str();
  }

 private:
  const scene::Camera* camera() const {
    return context_.scene.cameras.empty() ? nullptr : &context_.scene.cameras.front();
  }

  void add_sensor() {
    if (context_.scene.cameras.size() > 1)
      context_.written_instead("a scene is written with one camera, the one that is used; others are left out",
                               context_.scene.cameras[1].where);
    if (camera() != nullptr && !camera()->measured_shape) add_camera(sensors_, *camera(), context_, media_);
  }

  void add_lights() {
    const auto& lights = context_.scene.lights;
    if (std::count_if(lights.begin(), lights.end(), surrounds) > 1)
      context_.written_instead("Mitsuba takes one light that surrounds the scene only; all are written",
                               std::find_if(lights.begin(), lights.end(), surrounds)->where);
    for (const scene::Light& light : lights) add_light(content_, light, context_, textures_, shapes_);
  }

  void add_shapes() {
    for (std::uint32_t i = 0; i < context_.scene.instances.size(); ++i) {
      const bool is_measured = camera() != nullptr && camera()->measured_shape == i;
      shapes_.add(content_, context_.scene.instances[i], is_measured ? camera() : nullptr);
    }
  }

  WriterContext context_;
  TextureWriter textures_;
  MaterialWriter materials_;
  MediumWriter media_;
  ShapeWriter shapes_;
  pugi::xml_document sensors_, content_;
};

}  // namespace

bool write_file(const std::filesystem::path& path, const scene::SceneDescription& scene, Diagnostics& diagnostics,
                bool (*stopped)()) {
  SideFiles files(path, stopped);
  try {
    files.commit(SceneWriter(scene, files, diagnostics).text());
    return true;
  } catch (const SideFiles::Stopped&) {
    return false;
  }
}

}  // namespace etendue::mitsuba
