#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "math/spectrum.h"

namespace etendue {

/// Complex index of refraction η + ik against vacuum.
struct ComplexIor {
  Spectrum eta, k;
};

/// A metal (or another absorbing solid) by its usual name: "Au", "Al", "Cu_palik", …; measured data brought to RGB as
/// Mitsuba does it: through the observer without an illuminant. "none" is the perfect mirror, η = 0, k = 1. No value if
/// the name is not known.
std::optional<ComplexIor> named_conductor(std::string_view name);

/// All names that named_conductor knows (each but "none" also with "_palik" behind it), for "did you mean".
std::span<const std::string_view> conductor_names();

}  // namespace etendue
