#pragma once

#include "math/ray.h"
#include "math/transform.h"

namespace etendue {

enum class Projection {
  perspective,   ///< rays through a thin lens
  orthographic,  ///< parallel rays; tan_half_x and tan_half_y are half the picture's width and height in metres
  radiance,      ///< every pixel looks along the axis
  irradiance,    ///< every pixel looks at the hemispheres above a surface: rays are not generate_ray's
};

/// A camera with a thin lens: at `to_world.origin`, looking along its −z, +y up, the three axes orthonormal.
struct Camera {
  Transform to_world;
  Projection projection = Projection::perspective;
  float tan_half_x = 0.5f;     ///< half width of the picture on the plane at distance 1
  float tan_half_y = 0.375f;   ///< half height
  Vec2 principal_point{0, 0};  ///< where the picture's centre lies off the axis, in widths and heights, right and down
  float near_clip = 0;         ///< distance along the axis before which nothing is seen
  float far_clip = 0;          ///< the same beyond which nothing is seen; 0: none
  float lens_radius = 0;       ///< metres; 0: a pinhole
  float focal_distance = 1;    ///< along the axis, to the plane that is sharp
  int blades = 0;              ///< sides of the aperture's polygon; fewer than 3: a disk
  float blade_rotation = 0;    ///< radians, counter-clockwise seen from behind the camera
};

/// The ray through a point of the picture. `film` is in [0,1)² (or beyond, just outside the picture): x to the right, y
/// downwards. `lens` in [0,1)² picks a point of the aperture, uniformly by area. The direction is unit; t_min and t_max
/// hold the clipping planes.
Ray generate_ray(const Camera& camera, Vec2 film, Vec2 lens);

/// Where a world point is seen: film coordinates as in generate_ray (outside [0,1)² if out of the picture) and the
/// distance along the axis, through the lens' centre. The distance is negative behind the camera.
struct FilmPoint {
  Vec2 film;
  float distance;
};
FilmPoint project(const Camera& camera, const Point3& world);

/// Point of the aperture, uniform by area, from u in [0,1)²: the disk of the lens' radius, or the regular polygon whose
/// corners lie on its rim.
Vec2 sample_aperture(const Camera& camera, Vec2 u);

}  // namespace etendue
