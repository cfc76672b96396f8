#pragma once

#include "image/image.h"

/// Skies, and what spots throw, as the pictures by which Mitsuba knows them.
namespace etendue::mitsuba {

/// Light from above the horizon, whose edge is blurred over 0.2°. Its first row is the zenith, its last the nadir.
Image upper_half_picture(const Spectrum& radiance);

/// A map whose rows lie in the middle of equally high strips, as one whose first row is the zenith and whose last the
/// nadir, read from right to left: what bilinear lookups find is the same.
Image mirrored_map(const Image& map);

/// The falloff cos^exponent over a spot's cone of this half angle, as seen on a plane across its axis.
Image falloff_picture(float cutoff_deg, float exponent);

}  // namespace etendue::mitsuba
