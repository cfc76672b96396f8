#pragma once

#include <filesystem>
#include <string_view>

#include "camera/camera.h"

namespace etendue {

/// The teaching renderer's camera settings: white-space separated numbers
///   hFov vFov aspect near far (degrees) · position xyz · target xyz · phi theta r minR maxR ·
///   camera-to-world 3×3 row by row (columns right, up, back) · screen width height distance ·
///   focal distance, lens radius.
/// The last two may be missing (older files). The field of view grows along the too-narrow side when width / height
/// differs from the file's aspect. Throws Error(Failure::input) that says which number is missing or impossible.
Camera read_camera_settings(const std::filesystem::path& path, int width, int height);

/// The same from text; `path` only names it in messages.
Camera parse_camera_settings(std::string_view text, const std::filesystem::path& path, int width, int height);

/// Writes the same (whole or not at all); `target` is the point the camera turns about, on its axis.
/// Throws Error(Failure::output).
void write_camera_settings(const std::filesystem::path& path, const Camera& camera, const Point3& target, int width,
                           int height);

}  // namespace etendue
