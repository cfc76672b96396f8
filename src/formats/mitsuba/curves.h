#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/scene.h"

namespace etendue::mitsuba {

/// The control points of a curve file: lines "x y z radius", a blank line between one curve and the next.
/// Throws Error(Failure::input), "NAME:LINE: …".
scene::Curves parse_curves(std::string_view text, const std::string& name, scene::Curves::Basis basis);

/// The same for a file on disk.
scene::Curves read_curves(const std::filesystem::path& file, scene::Curves::Basis basis);

}  // namespace etendue::mitsuba
