#pragma once

#include "camera/camera.h"
#include "math/bounds.h"
#include "scene/scene.h"

namespace etendue {

/// Which camera a picture is made with.
enum class CameraPlacement {
  automatic,  ///< `fit` for files with the CGL profile, `file` for all others
  file,       ///< the file's own camera; the scene is framed if there is none
  fit,        ///< the teaching renderer's: direction and pixel size from the file, aimed at the scene's box
};

/// The camera for a picture of `width` × `height` pixels. `bounds` is the world-space box of all geometry.
///
/// `file`: the field of view is the file's; where the picture's aspect differs from the file's it grows along the
/// too-narrow side. `fit`: looks at the box' centre from 1.5 × its diagonal away, along the direction M·(0,0,−1) (M:
/// the camera node's matrix, y-up world), and a pixel is as large as in an 800 × 600 picture. A scene without camera is
/// framed from the front, whole; diagnostics says so.
Camera place_camera(const scene::SceneDescription& scene, const Bounds3& bounds, CameraPlacement placement, int width,
                    int height, Diagnostics& diagnostics);

}  // namespace etendue
