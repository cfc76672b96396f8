#pragma once

#include <string>

#include "scene/scene.h"

namespace etendue::mitsuba::test {

/// Everything in a scene that a picture of it depends on, as text: references are followed, so that it does not matter
/// in which order things stand and what they are called.
std::string text_of(const scene::SceneDescription& scene);

/// Where two such texts first differ by more than the last digits of a number; empty if they do not. Normals that are
/// made unit again may change there.
std::string first_difference(const std::string& a, const std::string& b);

}  // namespace etendue::mitsuba::test
