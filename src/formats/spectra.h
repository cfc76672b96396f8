#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "math/spectrum.h"

/// Spectral data in scene files, brought to linear Rec. 709 RGB through the CIE 1931 2° standard observer.
namespace etendue {

/// A quantity over wavelength as it was measured or written down: linear between the points, zero outside of them.
struct SpectralCurve {
  std::vector<double> wavelengths_nm;  ///< at least two, strictly increasing
  std::vector<double> values;          ///< as many
};

/// What a curve stands for; decides the white it is seen against and the range of the result.
enum class SpectrumRole {
  reflectance,  ///< seen under CIE D65, clamped to [0, 1]: a flat curve of value v becomes (v, v, v)
  unbounded,    ///< seen under CIE D65, never negative: extinction, an index of refraction given in the scene
  emission,     ///< a light by itself, never negative: a flat curve is the equal-energy white (1.205, 0.948, 0.909)
};

/// The colour of a curve: XYZ = ∫ curve · (D65 where the role says so) · (x̄, ȳ, z̄) dλ over 360–830 nm, scaled so that Y
/// of the constant 1 is 1, then to Rec. 709 primaries; components out of range are clamped.
Spectrum to_rgb(const SpectralCurve& curve, SpectrumRole role);

/// The colour of the same value at every wavelength. Emission: value · equal-energy white; otherwise (value, value,
/// value).
Spectrum constant_to_rgb(double value, SpectrumRole role);

/// "400:0.1, 500:0.2 …": wavelength in nm, colon, value; parted by commas or white space. Throws Error(Failure::input).
SpectralCurve parse_curve(std::string_view text);

/// An .spd file: "wavelength value" lines, '#' starts a comment. Throws Error(Failure::input) with file and line.
SpectralCurve read_spd(const std::filesystem::path& file);

/// Spectral radiance of a black body (Planck 1901), W·m⁻²·sr⁻¹·nm⁻¹, over 360–830 nm.
SpectralCurve blackbody(double kelvin);

/// CIE standard illuminant D65, scaled so that its Y is 1.
SpectralCurve illuminant_d65();

}  // namespace etendue
