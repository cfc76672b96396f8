#pragma once

namespace etendue {

/// How a mesh file is to be understood; what its own format cannot say.
struct MeshFileOptions {
  bool face_normals = false;     ///< flat: the file's normals are not looked at, none are made
  bool flip_normals = false;     ///< the front becomes the back: winding and normals are reversed
  bool flip_tex_coords = false;  ///< v becomes 1 − v (Mitsuba's default: true for OBJ, false for PLY)
};

}  // namespace etendue
