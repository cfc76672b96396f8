#include "formats/spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>

#include "base/error.h"

namespace etendue {
namespace {

/// The observer's three responses, or what it sees.
struct Xyz {
  double x = 0, y = 0, z = 0;
};

constexpr double kFirstNm = 360, kLastNm = 830, kTableStepNm = 5;

// CIE 1931 2° standard observer, x̄ ȳ z̄ from 360 nm to 830 nm in steps of 5 nm (CIE 018:2019).
constexpr Xyz kObserver[] = {{0.0001299, 3.917e-06, 0.0006061},
                             {0.0002321, 6.965e-06, 0.001086},
                             {0.0004149, 1.239e-05, 0.001946},
                             {0.0007416, 2.202e-05, 0.003486},
                             {0.001368, 3.9e-05, 0.006450001},
                             {0.002236, 6.4e-05, 0.01054999},
                             {0.004243, 0.00012, 0.02005001},
                             {0.00765, 0.000217, 0.03621},
                             {0.01431, 0.000396, 0.06785001},
                             {0.02319, 0.00064, 0.1102},
                             {0.04351, 0.00121, 0.2074},
                             {0.07763, 0.00218, 0.3713},
                             {0.13438, 0.004, 0.6456},
                             {0.21477, 0.0073, 1.0390501},
                             {0.2839, 0.0116, 1.3856},
                             {0.3285, 0.01684, 1.62296},
                             {0.34828, 0.023, 1.74706},
                             {0.34806, 0.0298, 1.7826},
                             {0.3362, 0.038, 1.77211},
                             {0.3187, 0.048, 1.7441},
                             {0.2908, 0.06, 1.6692},
                             {0.2511, 0.0739, 1.5281},
                             {0.19536, 0.09098, 1.28764},
                             {0.1421, 0.1126, 1.0419},
                             {0.09564, 0.13902, 0.8129501},
                             {0.05795001, 0.1693, 0.6162},
                             {0.03201, 0.20802, 0.46518},
                             {0.0147, 0.2586, 0.3533},
                             {0.0049, 0.323, 0.272},
                             {0.0024, 0.4073, 0.2123},
                             {0.0093, 0.503, 0.1582},
                             {0.0291, 0.6082, 0.1117},
                             {0.06327, 0.71, 0.07824999},
                             {0.1096, 0.7932, 0.05725001},
                             {0.1655, 0.862, 0.04216},
                             {0.2257499, 0.9148501, 0.02984},
                             {0.2904, 0.954, 0.0203},
                             {0.3597, 0.9803, 0.0134},
                             {0.4334499, 0.9949501, 0.008749999},
                             {0.5120501, 1, 0.005749999},
                             {0.5945, 0.995, 0.0039},
                             {0.6784, 0.9786, 0.002749999},
                             {0.7621, 0.952, 0.0021},
                             {0.8425, 0.9154, 0.0018},
                             {0.9163, 0.87, 0.001650001},
                             {0.9786, 0.8163, 0.0014},
                             {1.0263, 0.757, 0.0011},
                             {1.0567, 0.6949, 0.001},
                             {1.0622, 0.631, 0.0008},
                             {1.0456, 0.5668, 0.0006},
                             {1.0026, 0.503, 0.00034},
                             {0.9384, 0.4412, 0.00024},
                             {0.8544499, 0.381, 0.00019},
                             {0.7514, 0.321, 0.0001},
                             {0.6424, 0.265, 4.999999e-05},
                             {0.5419, 0.217, 3e-05},
                             {0.4479, 0.175, 2e-05},
                             {0.3608, 0.1382, 1e-05},
                             {0.2835, 0.107, 0},
                             {0.2187, 0.0816, 0},
                             {0.1649, 0.061, 0},
                             {0.1212, 0.04458, 0},
                             {0.0874, 0.032, 0},
                             {0.0636, 0.0232, 0},
                             {0.04677, 0.017, 0},
                             {0.0329, 0.01192, 0},
                             {0.0227, 0.00821, 0},
                             {0.01584, 0.005723, 0},
                             {0.01135916, 0.004102, 0},
                             {0.008110916, 0.002929, 0},
                             {0.005790346, 0.002091, 0},
                             {0.004109457, 0.001484, 0},
                             {0.002899327, 0.001047, 0},
                             {0.00204919, 0.00074, 0},
                             {0.001439971, 0.00052, 0},
                             {0.0009999493, 0.0003611, 0},
                             {0.0006900786, 0.0002492, 0},
                             {0.0004760213, 0.0001719, 0},
                             {0.0003323011, 0.00012, 0},
                             {0.0002348261, 8.48e-05, 0},
                             {0.0001661505, 6e-05, 0},
                             {0.000117413, 4.24e-05, 0},
                             {8.307527e-05, 3e-05, 0},
                             {5.870652e-05, 2.12e-05, 0},
                             {4.150994e-05, 1.499e-05, 0},
                             {2.935326e-05, 1.06e-05, 0},
                             {2.067383e-05, 7.4657e-06, 0},
                             {1.455977e-05, 5.2578e-06, 0},
                             {1.025398e-05, 3.7029e-06, 0},
                             {7.221456e-06, 2.6078e-06, 0},
                             {5.085868e-06, 1.8366e-06, 0},
                             {3.581652e-06, 1.2934e-06, 0},
                             {2.522525e-06, 9.1093e-07, 0},
                             {1.776509e-06, 6.4153e-07, 0},
                             {1.251141e-06, 4.5181e-07, 0}};

// CIE standard illuminant D65 at the same wavelengths (ISO/CIE 11664-2:2022); 100 at 560 nm.
constexpr double kD65[] = {
    46.6383, 49.3637, 52.0891, 51.0323, 49.9755, 52.3118, 54.6482, 68.7015, 82.7549, 87.1204, 91.486,  92.4589,
    93.4318, 90.057,  86.6823, 95.7736, 104.865, 110.936, 117.008, 117.41,  117.812, 116.336, 114.861, 115.392,
    115.923, 112.367, 108.811, 109.082, 109.354, 108.578, 107.802, 106.296, 104.79,  106.239, 107.689, 106.047,
    104.405, 104.225, 104.046, 102.023, 100,     98.1671, 96.3342, 96.0611, 95.788,  92.2368, 88.6856, 89.3459,
    90.0062, 89.8026, 89.5991, 88.6489, 87.6987, 85.4936, 83.2886, 83.4939, 83.6992, 81.863,  80.0268, 80.1207,
    80.2146, 81.2462, 82.2778, 80.281,  78.2842, 74.0027, 69.7213, 70.6652, 71.6091, 72.979,  74.349,  67.9765,
    61.604,  65.7448, 69.8856, 72.4863, 75.087,  69.3398, 63.5927, 55.0054, 46.4182, 56.6118, 66.8054, 65.0941,
    63.3828, 63.8434, 64.304,  61.8779, 59.4519, 55.7054, 51.959,  54.6998, 57.4406, 58.8765, 60.3125};

constexpr std::size_t kTableSize = std::size(kObserver);
static_assert(std::size(kD65) == kTableSize && kTableSize == 1 + (kLastNm - kFirstNm) / kTableStepNm);

/// Where a wavelength lies in a table: between entries `index` and `index + 1`.
struct TablePlace {
  std::size_t index;
  double fraction;
};

TablePlace place_in_table(double nm) {
  const double place = (nm - kFirstNm) / kTableStepNm;
  const auto index = std::min(static_cast<std::size_t>(place), kTableSize - 2);
  return {index, place - static_cast<double>(index)};
}

Xyz observer(double nm) {
  const auto [i, f] = place_in_table(nm);
  const Xyz &a = kObserver[i], &b = kObserver[i + 1];
  return {std::lerp(a.x, b.x, f), std::lerp(a.y, b.y, f), std::lerp(a.z, b.z, f)};
}

double d65(double nm) {
  const auto [i, f] = place_in_table(nm);
  return std::lerp(kD65[i], kD65[i + 1], f);
}

double value_at(const SpectralCurve& curve, double nm) {
  const std::vector<double>&w = curve.wavelengths_nm, &v = curve.values;
  if (nm < w.front() || nm > w.back()) return 0;
  const auto after = std::min(std::upper_bound(w.begin(), w.end(), nm), w.end() - 1);
  const auto i = static_cast<std::size_t>(after - w.begin());
  return std::lerp(v[i - 1], v[i], (nm - w[i - 1]) / (w[i] - w[i - 1]));
}

/// ∫ curve · illuminant · observer, scaled so that Y of the constant 1 is 1.
Xyz integrate(const SpectralCurve& curve, bool under_d65) {
  constexpr int kSamples = 1000;
  Xyz sum;
  double sum_of_one = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double nm = std::lerp(kFirstNm, kLastNm, i / (kSamples - 1.0));
    const Xyz response = observer(nm);
    const double light = under_d65 ? d65(nm) : 1, value = value_at(curve, nm) * light;
    sum.x += response.x * value;
    sum.y += response.y * value;
    sum.z += response.z * value;
    sum_of_one += response.y * light;
  }
  return {sum.x / sum_of_one, sum.y / sum_of_one, sum.z / sum_of_one};
}

/// To linear Rec. 709 (ITU-R BT.709 primaries and white, inverse of its RGB → XYZ matrix).
std::array<double, 3> to_rec709(const Xyz& c) {
  return {3.240479 * c.x - 1.537150 * c.y - 0.498535 * c.z, -0.969256 * c.x + 1.875991 * c.y + 0.041556 * c.z,
          0.055648 * c.x - 0.204043 * c.y + 1.057311 * c.z};
}

Spectrum to_spectrum(const std::array<double, 3>& rgb, double most) {
  const auto clamped = [&](double value) { return static_cast<float>(std::clamp(value, 0.0, most)); };
  return {clamped(rgb[0]), clamped(rgb[1]), clamped(rgb[2])};
}

bool is_separator(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',';
}

/// The finite number that `text` consists of.
std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Cuts the first word off `text`; empty if there is none.
std::string_view next_word(std::string_view& text) {
  while (!text.empty() && is_separator(text.front())) text.remove_prefix(1);
  std::size_t length = 0;
  while (length < text.size() && !is_separator(text[length])) ++length;
  const std::string_view word = text.substr(0, length);
  text.remove_prefix(length);
  return word;
}

/// Takes a further point; what is wrong with it, if it is.
std::optional<std::string> add_point(SpectralCurve& curve, std::string_view wavelength, std::string_view value) {
  const std::optional<double> nm = parse_number(wavelength), v = parse_number(value);
  if (!nm) return fmt::format("\"{}\" is not a wavelength in nanometres", wavelength);
  if (!v) return fmt::format("\"{}\" is not a number", value);
  if (!curve.wavelengths_nm.empty() && *nm <= curve.wavelengths_nm.back())
    return fmt::format("the wavelength {} does not lie beyond the one before it, {}", *nm, curve.wavelengths_nm.back());
  curve.wavelengths_nm.push_back(*nm);
  curve.values.push_back(*v);
  return std::nullopt;
}

}  // namespace

Spectrum to_rgb(const SpectralCurve& curve, SpectrumRole role) {
  const Xyz xyz = integrate(curve, role != SpectrumRole::emission);
  return to_spectrum(to_rec709(xyz), role == SpectrumRole::reflectance ? 1.0 : HUGE_VAL);
}

Spectrum constant_to_rgb(double value, SpectrumRole role) {
  if (role != SpectrumRole::emission) return Spectrum(static_cast<float>(value));
  return to_spectrum(to_rec709({value, value, value}), HUGE_VAL);
}

SpectralCurve parse_curve(std::string_view text) {
  SpectralCurve curve;
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text)) {
    const std::size_t colon = word.find(':');
    if (colon == word.npos)
      throw Error(Failure::input, fmt::format("\"{}\" in a spectrum is not of the form wavelength:value", word));
    if (const auto problem = add_point(curve, word.substr(0, colon), word.substr(colon + 1)))
      throw Error(Failure::input, fmt::format("in a spectrum, {}", *problem));
  }
  if (curve.values.size() < 2)
    throw Error(Failure::input, "a spectrum needs at least two wavelengths, for example \"400:0.2, 700:0.8\"");
  return curve;
}

SpectralCurve read_spd(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Error(Failure::input, fmt::format("{}: the file cannot be opened for reading", file.string()));
  SpectralCurve curve;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::string_view rest(line);
    rest = rest.substr(0, rest.find('#'));
    const std::string_view wavelength = next_word(rest), value = next_word(rest), third = next_word(rest);
    if (wavelength.empty()) continue;
    std::optional<std::string> problem;
    if (value.empty() || !third.empty())
      problem = "a line must hold a wavelength in nanometres and a value";
    else
      problem = add_point(curve, wavelength, value);
    if (problem) throw Error(Failure::input, fmt::format("{}:{}: {}", file.string(), number, *problem));
  }
  if (curve.values.size() < 2)
    throw Error(Failure::input, fmt::format("{}: a spectrum needs at least two wavelengths", file.string()));
  return curve;
}

SpectralCurve blackbody(double kelvin) {
  constexpr double kPlanck = 6.62607015e-34, kLightSpeed = 299792458,
                   kBoltzmann = 1.380649e-23;  // SI, exact since 2019
  SpectralCurve curve;
  for (double nm = kFirstNm; nm <= kLastNm; nm += 1) {
    const double metres = nm * 1e-9;
    const double photon_energy = kPlanck * kLightSpeed / metres;
    const double per_metre =
        2 * photon_energy * kLightSpeed / std::pow(metres, 4) / std::expm1(photon_energy / (kBoltzmann * kelvin));
    curve.wavelengths_nm.push_back(nm);
    curve.values.push_back(per_metre * 1e-9);
  }
  return curve;
}

SpectralCurve illuminant_d65() {
  double y_of_d65 = 0, y_of_one = 0;
  for (std::size_t i = 0; i < kTableSize; ++i) {
    y_of_d65 += kObserver[i].y * kD65[i];
    y_of_one += kObserver[i].y;
  }
  SpectralCurve curve;
  for (std::size_t i = 0; i < kTableSize; ++i) {
    curve.wavelengths_nm.push_back(kFirstNm + kTableStepNm * static_cast<double>(i));
    curve.values.push_back(kD65[i] * y_of_one / y_of_d65);
  }
  return curve;
}

}  // namespace etendue
