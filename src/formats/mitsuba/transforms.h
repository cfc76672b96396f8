#pragma once

#include "formats/mitsuba/document.h"
#include "math/transform.h"

namespace etendue::mitsuba {

/// A <transform>: its steps one after the other. Throws Problem.
Transform read_transform(const Element& element, Report& report);

/// Frame of an observer as Mitsuba has it: at `eye`, looking along +z to `target`, +y up, +x to the left. Not finite if
/// the three are on a line.
Transform look_at(const Point3& eye, const Point3& target, const Vec3& up);

/// A direction across `direction` (unit), the one that Mitsuba takes as "up" where none is given.
Vec3 any_up(const Vec3& direction);

/// Mitsuba's observers and lamps look along their +z with +x to the left; ours along −z with +x to the right.
Transform facing_backwards(const Transform& to_world);

bool is_finite(const Transform& t);

}  // namespace etendue::mitsuba
