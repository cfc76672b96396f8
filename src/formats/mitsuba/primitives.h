#pragma once

#include "scene/scene.h"

namespace etendue::mitsuba {

/// The square [−1, 1]² in the xy plane, its front +z, as a mesh with normals; texture coordinates from 0 to 1 along x
/// and y.
scene::Mesh rectangle(bool flip_normals);
/// The cube [−1, 1]³, each side with normals and texture coordinates of its own.
scene::Mesh cube(bool flip_normals);

}  // namespace etendue::mitsuba
