#include "formats/volume_file.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "formats/file_bytes.h"

namespace etendue {
namespace {

[[noreturn]] void reject(const std::string& name, std::string_view message) {
  throw Error(Failure::input, fmt::format("{}: {}", name, message));
}

/// Number of values, at most as many as the `left` bytes can hold.
std::size_t value_count(const scene::GridVolume& grid, std::size_t left, const std::string& name) {
  const std::size_t most = left / sizeof(float);
  std::size_t count = static_cast<std::size_t>(grid.channels);
  for (const int cells : grid.size) {
    if (cells <= 0) reject(name, fmt::format("the grid is {} cells wide; there must be at least one", cells));
    if (static_cast<std::size_t>(cells) > most / count)
      reject(name, fmt::format("the grid has {} × {} × {} cells, but only {} bytes follow", grid.size[0], grid.size[1],
                               grid.size[2], left));
    count *= static_cast<std::size_t>(cells);
  }
  return count;
}

}  // namespace

VolumeFile read_volume_file(const std::filesystem::path& file, Diagnostics& diagnostics) {
  return parse_volume_file(read_file_bytes(file), file.string(), diagnostics);
}

VolumeFile parse_volume_file(std::string_view bytes, const std::string& name, Diagnostics& diagnostics) {
  ByteReader reader(bytes, name);
  if (reader.take(3) != "VOL") reject(name, "this is not a volume file: it does not begin with \"VOL\"");
  if (const int version = reader.next<std::uint8_t>(); version != 3)
    reject(name, fmt::format("version {} of the volume format is not known; known is 3", version));
  if (const auto type = reader.next<std::int32_t>(); type != 1)
    reject(name, fmt::format("values of type {} are not known; known are 32-bit floats, type 1", type));

  VolumeFile volume;
  scene::GridVolume& grid = volume.grid;
  for (int& cells : grid.size) cells = reader.next<std::int32_t>();
  grid.channels = reader.next<std::int32_t>();
  if (grid.channels != 1 && grid.channels != 3)
    reject(name, fmt::format("the grid has {} channels; 1 or 3 are supported", grid.channels));
  for (float& coordinate : volume.box_min) coordinate = reader.next<float>();
  for (float& coordinate : volume.box_max) coordinate = reader.next<float>();

  const std::size_t count = value_count(grid, reader.left(), name);
  grid.values.reserve(count);
  std::uint64_t not_finite = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float value = reader.next<float>();
    not_finite += std::isfinite(value) ? 0 : 1;
    grid.values.push_back(std::isfinite(value) ? value : 0);
  }
  if (not_finite > 0)
    diagnostics.repaired(fmt::format("{}: a value of the grid is not finite; 0 is used", name), {}, not_finite);
  return volume;
}

std::string volume_file_bytes(const scene::GridVolume& grid) {
  std::string bytes = "VOL";
  store_number(bytes, std::uint8_t{3});
  store_number(bytes, std::int32_t{1});
  for (const int cells : grid.size) store_number(bytes, std::int32_t{cells});
  store_number(bytes, std::int32_t{grid.channels});
  for (const float corner : {0.0f, 1.0f})
    for (int axis = 0; axis < 3; ++axis) store_number(bytes, corner);
  for (const float value : grid.values) store_number(bytes, value);
  return bytes;
}

}  // namespace etendue
