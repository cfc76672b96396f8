#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "scene/scene.h"

namespace etendue {

/// What a Mitsuba volume file holds: values on a grid, and the box that it says they fill.
struct VolumeFile {
  scene::GridVolume grid;  ///< filter and wrap as by default: the file does not say
  std::array<float, 3> box_min{0, 0, 0}, box_max{1, 1, 1};
};

/// Reads a .vol file (version 3, 32-bit floats, 1 or 3 channels). Values that are not finite become 0,
/// with a counted warning; throws Error(Failure::input) that names the file.
VolumeFile read_volume_file(const std::filesystem::path& file, Diagnostics& diagnostics);

/// The same for a file's bytes; `name` stands for the file in messages.
VolumeFile parse_volume_file(std::string_view bytes, const std::string& name, Diagnostics& diagnostics);

/// The bytes of the .vol file that holds these values and says that they fill the unit cube.
std::string volume_file_bytes(const scene::GridVolume& grid);

}  // namespace etendue
