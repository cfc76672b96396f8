#pragma once

#include "formats/mitsuba/properties.h"
#include "formats/spectra.h"
#include "math/spectrum.h"

namespace etendue::mitsuba {

/// Whether the element says one colour for everywhere: a number, <rgb>, <spectrum>.
bool is_constant_color(const Element& element);

/// That colour, as Mitsuba's RGB mode sees it. Throws Problem.
Spectrum read_spectrum(const Document& document, const Element& element, SpectrumRole role, Report& report);

}  // namespace etendue::mitsuba
