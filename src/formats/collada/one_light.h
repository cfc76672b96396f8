#pragma once

#include "base/diagnostics.h"
#include "formats/report.h"
#include "scene/scene.h"

namespace etendue::collada {

/// The scene's lights without those that also stand there as a mesh.
///
/// The CGL profile's files describe a lamp twice: as an area light, which is sampled, and as an emissive mesh, which is
/// seen. A rectangle that lies in the plane of an emissive mesh of the same radiance, faces the same way and overlaps
/// it is that mesh; counting both would double the light. The mesh stays, and one information says so. The two need not
/// match exactly: planes may be 1 % of the rectangle's size plus 0.01 m apart, and in many files one of them is a
/// quarter turn off.
std::vector<scene::Light> without_doubled_lights(const scene::SceneDescription& scene, Report& report);

}  // namespace etendue::collada
