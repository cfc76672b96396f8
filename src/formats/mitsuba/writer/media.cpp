#include "formats/mitsuba/writer/media.h"

namespace etendue::mitsuba {

void MediumWriter::add(pugi::xml_node parent, const std::string& name,
                       const std::optional<scene::Id<scene::Medium>>& medium) {
  if (medium) add_reference(parent, name, id(*medium));
}

const std::string& MediumWriter::id(scene::Id<scene::Medium> id) {
  const auto [place, is_new] = ids_.try_emplace(id.index);
  if (!is_new) return place->second;
  const scene::Medium& medium = context_.scene.media[id.index];
  place->second = context_.ids.unique(medium.name, "medium");
  const bool is_constant =
      std::holds_alternative<Spectrum>(medium.sigma_t) && std::holds_alternative<Spectrum>(medium.albedo);
  pugi::xml_node node = add_object(elements_, "medium", is_constant ? "homogeneous" : "heterogeneous", place->second);
  textures_.add(node, "sigma_t", medium.sigma_t);
  textures_.add(node, "albedo", medium.albedo);
  add_number(node, "scale", medium.scale);
  if (const auto* phase = std::get_if<scene::HenyeyGreensteinPhase>(&medium.phase))
    add_number(add_object(node, "phase", "hg"), "g", phase->g);
  else
    add_object(node, "phase", "isotropic");
  return place->second;
}

}  // namespace etendue::mitsuba
