#include "formats/mitsuba/spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "base/error.h"
#include "formats/mitsuba/values.h"

namespace etendue::mitsuba {
namespace {

constexpr std::string_view kSpectrumTypes[] = {"blackbody", "d65", "irregular", "regular", "rgb", "srgb", "uniform"};

/// What the shared readers of spectra throw names no place in this file.
template <typename Function>
auto placed_at(SourceLocation where, Function function) {
  try {
    return function();
  } catch (const Error& error) {
    throw Problem(error.what(), where);
  }
}

Spectrum from_numbers(const Attribute& attribute) {
  const std::vector<float> v = numbers_of(attribute);
  if (v.size() == 1) return Spectrum(v[0]);
  if (v.size() == 3) return {v[0], v[1], v[2]};
  throw Problem(
      fmt::format("the colour {} has {} numbers; it needs one or three", in_quotes(attribute.value), v.size()),
      attribute.where);
}

float decoded_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

/// <srgb> of version 0.6: three numbers, or #rrggbb, with the sRGB transfer curve (IEC 61966-2-1).
Spectrum from_srgb(const Attribute& attribute) {
  const std::string_view text = attribute.value;
  Spectrum color;
  if (text.starts_with('#') && text.size() == 7) {
    for (int i = 0; i < 3; ++i) {
      int byte = 0;
      const char* const digits = text.data() + 1 + 2 * i;
      if (std::from_chars(digits, digits + 2, byte, 16).ptr != digits + 2)
        throw Problem(fmt::format("{} is not a colour like \"#80ff00\"", in_quotes(text)), attribute.where);
      color[i] = static_cast<float>(byte) / 255;
    }
  } else {
    color = from_numbers(attribute);
  }
  return {decoded_srgb(color.r), decoded_srgb(color.g), decoded_srgb(color.b)};
}

Spectrum from_file(const Document& document, const Attribute& attribute, SpectrumRole role) {
  const auto path = document.find_file(attribute.value, attribute.where);
  return placed_at(attribute.where, [&] { return to_rgb(read_spd(path), role); });
}

/// <spectrum value="…"/> or filename="…".
Spectrum from_spectrum(const Document& document, const Element& element, SpectrumRole role) {
  const Attribute *value = element.find("value"), *file = element.find("filename");
  if ((value == nullptr) == (file == nullptr))
    throw Problem("<spectrum> needs either a \"value\" or a \"filename\"", element.where);
  if (file != nullptr) return from_file(document, *file, role);
  if (value->value.find(':') != std::string::npos)
    return placed_at(value->where, [&] { return to_rgb(parse_curve(value->value), role); });
  const std::vector<std::string_view> words = words_of(value->value);
  if (words.size() != 1)
    throw Problem(
        fmt::format("the spectrum {} is neither one number nor wavelength:value pairs", in_quotes(value->value)),
        value->where);
  return constant_to_rgb(to_number(words.front(), *value), role);
}

std::vector<double> numbers_in(Properties& properties, std::string_view name) {
  const std::string text = properties.required_text(name);
  const std::vector<float> numbers = numbers_of(required(*properties.find(name), "value"));
  return {numbers.begin(), numbers.end()};
}

SpectralCurve regular_curve(Properties& properties) {
  const float begin = properties.number("wavelength_min", 360), end = properties.number("wavelength_max", 830);
  SpectralCurve curve{{}, numbers_in(properties, "values")};
  const std::size_t count = curve.values.size();
  if (count < 2 || !(begin < end))
    throw Problem("a regular spectrum needs two values or more, and wavelength_min below wavelength_max",
                  properties.where());
  for (std::size_t i = 0; i < count; ++i)
    curve.wavelengths_nm.push_back(begin + (end - begin) * static_cast<double>(i) / static_cast<double>(count - 1));
  return curve;
}

SpectralCurve irregular_curve(Properties& properties) {
  SpectralCurve curve{numbers_in(properties, "wavelengths"), numbers_in(properties, "values")};
  const auto& nm = curve.wavelengths_nm;
  const bool increasing = std::adjacent_find(nm.begin(), nm.end(), std::greater_equal<>()) == nm.end();
  if (nm.size() < 2 || nm.size() != curve.values.size() || !increasing)
    throw Problem("an irregular spectrum needs two wavelengths or more, increasing, and as many values",
                  properties.where());
  return curve;
}

/// <spectrum type="…">.
Spectrum from_object(const Document& document, const Element& element, SpectrumRole role, Report& report) {
  Properties properties(document, element, report);
  const std::string_view type = element.type();
  const auto color = [&](std::string_view name) {
    const Element* given = properties.find(name);
    return given == nullptr ? Spectrum(1) : read_spectrum(document, *given, SpectrumRole::unbounded, report);
  };
  Spectrum result;
  if (type == "uniform") {
    properties.ignore({"wavelength_min", "wavelength_max"});
    result = Spectrum(properties.number("value", 1));
  } else if (type == "d65") {
    result = color("color") * properties.number("scale", 1);
  } else if (type == "rgb" || type == "srgb") {
    properties.ignore({"unbounded"});
    result = properties.has("value") ? color("value") : color("color");
  } else if (type == "blackbody") {
    properties.ignore({"wavelength_min", "wavelength_max"});
    result = to_rgb(blackbody(properties.number("temperature", 5000, 1, 1e6f)), SpectrumRole::emission) *
             properties.number("scale", 1);
  } else if (const Element* value = properties.find("value")) {
    result = read_spectrum(document, *value, role, report);
  } else {
    result = to_rgb(type == "regular" ? regular_curve(properties) : irregular_curve(properties), role);
  }
  properties.reject_unread();
  return result;
}

/// <blackbody> of version 0.6.
Spectrum from_blackbody(const Element& element) {
  const Attribute& temperature = required(element, "temperature");
  std::string_view text = temperature.value;
  if (text.ends_with('K')) text.remove_suffix(1);
  const float kelvin = to_number(text, temperature);
  if (!(kelvin > 0)) throw Problem("a black body's temperature needs to be above zero", temperature.where);
  const Attribute* scale = element.find("scale");
  return to_rgb(blackbody(kelvin), SpectrumRole::emission) * (scale == nullptr ? 1 : to_number(scale->value, *scale));
}

Spectrum read_any(const Document& document, const Element& element, SpectrumRole role, Report& report) {
  if (element.tag == "float" || element.tag == "integer" || element.tag == "rgb")
    return from_numbers(required(element, "value"));
  if (element.tag == "srgb") return from_srgb(required(element, "value"));
  if (element.tag == "blackbody") return from_blackbody(element);
  return element.is_object() ? from_object(document, element, role, report) : from_spectrum(document, element, role);
}

/// Brings a colour into the range that its role allows. Plain numbers may be above 1 everywhere: some stand for more
/// than colours.
Spectrum within_range(const Spectrum& color, SpectrumRole role, const Element& element, Report& report) {
  const bool is_bounded = role == SpectrumRole::reflectance && (element.tag == "rgb" || element.tag == "srgb");
  const float most = is_bounded ? 1.0f : std::numeric_limits<float>::max();
  Spectrum result;
  for (int i = 0; i < 3; ++i) result[i] = std::clamp(color[i], 0.0f, most);
  if (result != color)
    report.repaired(is_bounded ? "a colour of a surface is not in 0 … 1; it is brought there"
                               : "a colour is below zero; zero is used",
                    element.where);
  return result;
}

}  // namespace

bool is_constant_color(const Element& element) {
  for (const std::string_view tag : {"float", "integer", "rgb", "srgb", "blackbody"})
    if (element.tag == tag) return true;
  if (element.tag == "spectrum" && !element.is_object()) return true;
  const bool is_texture = element.tag == "spectrum" || element.tag == "texture";
  return is_texture &&
         std::find(std::begin(kSpectrumTypes), std::end(kSpectrumTypes), element.type()) != std::end(kSpectrumTypes);
}

Spectrum read_spectrum(const Document& document, const Element& element, SpectrumRole role, Report& report) {
  if (!is_constant_color(element))
    throw Problem(fmt::format("a <{}> is not a colour; write <rgb> or <spectrum>", element.tag), element.where);
  return within_range(read_any(document, element, role, report), role, element, report);
}

}  // namespace etendue::mitsuba
