#pragma once

#include <algorithm>
#include <cmath>

namespace etendue {

/// A spectral quantity, kept as linear Rec. 709 RGB.
struct Spectrum {
  float r = 0, g = 0, b = 0;

  constexpr Spectrum() = default;
  constexpr explicit Spectrum(float value) : r(value), g(value), b(value) {}
  constexpr Spectrum(float red, float green, float blue) : r(red), g(green), b(blue) {}

  constexpr float& operator[](int i) { return i == 0 ? r : i == 1 ? g : b; }
  constexpr float operator[](int i) const { return i == 0 ? r : i == 1 ? g : b; }

  constexpr Spectrum& operator+=(const Spectrum& o) { return *this = {r + o.r, g + o.g, b + o.b}; }
  constexpr Spectrum& operator*=(const Spectrum& o) { return *this = {r * o.r, g * o.g, b * o.b}; }
  constexpr Spectrum& operator*=(float s) { return *this = {r * s, g * s, b * s}; }

  friend constexpr Spectrum operator+(const Spectrum& p, const Spectrum& q) {
    return {p.r + q.r, p.g + q.g, p.b + q.b};
  }
  friend constexpr Spectrum operator-(const Spectrum& p, const Spectrum& q) {
    return {p.r - q.r, p.g - q.g, p.b - q.b};
  }
  friend constexpr Spectrum operator*(const Spectrum& p, const Spectrum& q) {
    return {p.r * q.r, p.g * q.g, p.b * q.b};
  }
  friend constexpr Spectrum operator/(const Spectrum& p, const Spectrum& q) {
    return {p.r / q.r, p.g / q.g, p.b / q.b};
  }
  friend constexpr Spectrum operator*(const Spectrum& a, float s) { return {a.r * s, a.g * s, a.b * s}; }
  friend constexpr Spectrum operator*(float s, const Spectrum& a) { return a * s; }
  friend constexpr Spectrum operator/(const Spectrum& a, float s) { return a * (1.0f / s); }
  friend constexpr bool operator==(const Spectrum&, const Spectrum&) = default;

  constexpr bool is_black() const { return r == 0 && g == 0 && b == 0; }
  constexpr float max() const { return std::max(r, std::max(g, b)); }
  constexpr float average() const { return (r + g + b) * (1.0f / 3.0f); }
  /// Relative luminance Y of linear Rec. 709 (ITU-R BT.709).
  constexpr float luminance() const { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }
};

inline bool is_finite(const Spectrum& s) {
  return std::isfinite(s.r) && std::isfinite(s.g) && std::isfinite(s.b);
}

}  // namespace etendue
