#pragma once

#include "geometry/geometry.h"
#include "lights/light.h"

namespace etendue {

/// The light that a mesh of radiance `emitted` is: a RectangleLight if it is one flat rectangle, else a MeshLight whose
/// triangles are numbered like the mesh's. The mesh has no degenerate triangles.
Light make_area_light(const TriangleMesh& mesh, const Spectrum& emitted);

}  // namespace etendue
