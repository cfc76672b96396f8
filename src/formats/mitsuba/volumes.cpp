#include "formats/mitsuba/volumes.h"

#include <fmt/format.h>

#include "base/error.h"
#include "formats/mitsuba/spectra.h"
#include "formats/volume_file.h"

namespace etendue::mitsuba {
namespace {

/// From the unit cube to the box that the file says its grid fills.
Transform box_transform(const VolumeFile& file) {
  const Vec3 least(file.box_min[0], file.box_min[1], file.box_min[2]),
      most(file.box_max[0], file.box_max[1], file.box_max[2]);
  return Transform::translation(least) * Transform::scaling(most - least);
}

VolumeFile read_file(const std::filesystem::path& path, SourceLocation where, Diagnostics& diagnostics) {
  try {
    return read_volume_file(path, diagnostics);
  } catch (const Error& error) {
    throw Problem(error.what(), where);
  }
}

}  // namespace

scene::VolumeInput VolumeLibrary::input(Properties& properties, std::string_view name, float missing) {
  const Element* element = properties.find(name);
  if (element == nullptr) return Spectrum(missing);
  if (element->tag == "volume") return volume(properties.document(), *element, properties.report());
  // What Mitsuba makes of wavelengths here is a reflectance, whatever they are for; numbers and <rgb> it takes as they
  // are.
  const bool has_wavelengths = element->tag == "spectrum" && !element->is_object();
  return read_spectrum(properties.document(), *element,
                       has_wavelengths ? SpectrumRole::reflectance : SpectrumRole::unbounded, properties.report());
}

scene::VolumeInput VolumeLibrary::extinction(Properties& properties, std::string_view name, float missing) {
  const scene::VolumeInput value = input(properties, name, missing);
  const auto* constant = std::get_if<Spectrum>(&value);
  if (constant == nullptr) return value;
  scene::GridVolume grid;
  grid.channels = 3;
  grid.values = {constant->r, constant->g, constant->b};
  scene::Volume volume;
  volume.source = std::move(grid);
  if (const Element* element = properties.find(name); element != nullptr && element->tag == "volume")
    volume.to_world = Properties(properties.document(), *element, properties.report()).transform("to_world");
  scene_.volumes.push_back(std::move(volume));
  return scene::Id<scene::Volume>{static_cast<std::uint32_t>(scene_.volumes.size() - 1)};
}

scene::VolumeInput VolumeLibrary::volume(const Document& document, const Element& element, Report& report) {
  if (const auto known = known_.find(&element); known != known_.end()) return known->second;
  return known_.emplace(&element, read(document, element, report)).first->second;
}

scene::VolumeInput VolumeLibrary::read(const Document& document, const Element& element, Report& report) {
  Properties properties(document, element, report);
  scene::VolumeInput result = Spectrum(1);
  if (element.type() == "constvolume") {
    properties.ignore({"to_world"});
    if (const Element* value = properties.find("value"))
      result = read_spectrum(document, *value, SpectrumRole::unbounded, report);
  } else if (element.type() == "gridvolume") {
    result = read_grid(properties);
  } else {
    report.warning(fmt::format("the volume {} is not known here; the constant 1 is used", in_quotes(element.type())),
                   element.where);
    return result;
  }
  properties.reject_unread();
  return result;
}

scene::VolumeInput VolumeLibrary::read_grid(Properties& properties) {
  scene::Volume volume;
  volume.name = properties.name();
  volume.where = properties.where();
  volume.to_world = properties.transform("to_world");
  const std::filesystem::path path = properties.file("filename");
  const bool is_nearest = properties.choice("filter_type", {"trilinear", "nearest"}) == 1;
  constexpr scene::TextureWrap kWraps[] = {scene::TextureWrap::clamp, scene::TextureWrap::repeat,
                                           scene::TextureWrap::mirror};
  const scene::TextureWrap wrap = kWraps[properties.choice("wrap_mode", {"clamp", "repeat", "mirror"})];
  const bool use_box = properties.boolean("use_grid_bbox", false);
  properties.ignore({"raw", "accel", "max_value"});

  if (path.extension() == ".vdb" || path.extension() == ".nvdb") {
    volume.source = scene::VdbVolume{path, properties.text("grid").value_or("")};
  } else {
    VolumeFile file = read_file(path, properties.find("filename")->where, properties.report().diagnostics());
    file.grid.filter = is_nearest ? scene::TextureFilter::nearest : scene::TextureFilter::bilinear;
    file.grid.wrap = wrap;
    if (use_box) volume.to_world = volume.to_world * box_transform(file);
    volume.source = std::move(file.grid);
  }
  scene_.volumes.push_back(std::move(volume));
  return scene::Id<scene::Volume>{static_cast<std::uint32_t>(scene_.volumes.size() - 1)};
}

}  // namespace etendue::mitsuba
