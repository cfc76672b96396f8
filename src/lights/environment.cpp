#include "lights/environment.h"

#include <algorithm>
#include <cmath>

#include "math/turns.h"

namespace etendue {

double row_solid_angle(int row, int height) {
  return std::cos(std::numbers::pi * row / height) - std::cos(std::numbers::pi * (row + 1) / height);
}

namespace {

/// The cumulative shares of `weights`; uniform if their sum is 0. The last is exactly 1.
std::vector<float> cumulate(std::span<const double> weights) {
  std::vector<float> cdf(weights.size());
  double total = 0;
  for (const double w : weights) total += w;
  double sum = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += total > 0 ? weights[i] / total : 1.0 / static_cast<double>(weights.size());
    cdf[i] = static_cast<float>(std::min(sum, 1.0));
  }
  cdf.back() = 1;
  // Trailing texels without weight must not inherit what rounding left over.
  for (std::size_t i = weights.size(); total > 0 && i-- > 1 && weights[i] == 0;) cdf[i - 1] = 1;
  return cdf;
}

}  // namespace

TexelDistribution::TexelDistribution(const Image& map)
    : width_(map.width()), height_(map.height()), row_cdf_(1, map.height()), column_cdf_(map.height(), map.width()) {
  std::vector<double> texels(width_), rows(height_);
  double total = 0;
  for (const Spectrum& s : map.pixels()) total += s.luminance();
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      texels[x] = total > 0 ? map.at(x, y).luminance() : 1.0;
      rows[y] += texels[x];
    }
    rows[y] *= row_solid_angle(y, height_);
    column_cdf_.set_row(y, cumulate(texels));
  }
  row_cdf_.set_row(0, cumulate(rows));
}

TexelDistribution::Sample TexelDistribution::sample(Vec2 u) const {
  Sample found;
  sample(std::span(&u, 1), std::span(&found, 1));
  return found;
}

void TexelDistribution::sample(std::span<const Vec2> u, std::span<Sample> samples) const {
  const std::size_t n = samples.size();
  int row_index[kMostAtOnce] = {};
  float ux[kMostAtOnce], uy[kMostAtOnce];
  CumulativeRows::Interval rows[kMostAtOnce], columns[kMostAtOnce];
  for (std::size_t i = 0; i < n; ++i) {
    ux[i] = u[i].x;
    uy[i] = u[i].y;
  }
  row_cdf_.find(std::span(row_index, n), std::span(uy, n), std::span(rows, n));
  for (std::size_t i = 0; i < n; ++i) row_index[i] = rows[i].index;
  column_cdf_.find(std::span(row_index, n), std::span(ux, n), std::span(columns, n));
  const auto width = static_cast<float>(width_), height = static_cast<float>(height_);
  for (std::size_t i = 0; i < n; ++i) {
    const float x = (static_cast<float>(columns[i].index) + columns[i].remapped(ux[i])) / width;
    const float y = (static_cast<float>(rows[i].index) + rows[i].remapped(uy[i])) / height;
    samples[i] = {{std::min(x, kOneMinusEpsilon), std::min(y, kOneMinusEpsilon)},
                  rows[i].width() * columns[i].width() * width * height};
  }
}

float TexelDistribution::pdf(Vec2 uv) const {
  const int x = std::clamp(static_cast<int>(uv.x * static_cast<float>(width_)), 0, width_ - 1);
  const int y = std::clamp(static_cast<int>(uv.y * static_cast<float>(height_)), 0, height_ - 1);
  // The product of the two intervals as rounding left them: the density of what is really sampled.
  const float row = row_cdf(y) - (y > 0 ? row_cdf(y - 1) : 0.0f);
  const float column = column_cdf(y, x) - (x > 0 ? column_cdf(y, x - 1) : 0.0f);
  return row * column * static_cast<float>(width_) * static_cast<float>(height_);
}

Image lookup_means(const Image& map, MapRows rows) {
  const int w = map.width(), h = map.height();
  const auto weighted = [](const Spectrum& before, const Spectrum& here, const Spectrum& after) {
    return before * 0.125f + here * 0.75f + after * 0.125f;  // a tent of width 2 averaged over the middle unit
  };
  Image columns(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      columns.at(x, y) = weighted(map.at((x + w - 1) % w, y), map.at(x, y), map.at((x + 1) % w, y));
  if (rows == MapRows::centered || h == 1) {
    Image out(w, h);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        out.at(x, y) =
            weighted(columns.at(x, std::max(y - 1, 0)), columns.at(x, y), columns.at(x, std::min(y + 1, h - 1)));
    return out;
  }
  Image out(w, h - 1);
  for (int y = 0; y + 1 < h; ++y)
    for (int x = 0; x < w; ++x) out.at(x, y) = (columns.at(x, y) + columns.at(x, y + 1)) * 0.5f;
  return out;
}

Image compensated(const Image& means) {
  constexpr float kRoundingShare = 1e-4f;  // an even sky has no bright places
  const int w = means.width(), h = means.height();
  double sum = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) sum += means.at(x, y).luminance() * row_solid_angle(y, h);
  const auto mean = static_cast<float>(sum / (2.0 * w));  // the solid angles of a column sum to 2
  Image out(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const float excess = means.at(x, y).luminance() - mean;
      out.at(x, y) = Spectrum(excess > kRoundingShare * mean ? excess : 0.0f);
    }
  return out;
}

MapRepairs repair_map(Image& map) {
  MapRepairs repairs;
  bool light = false;
  for (Spectrum& s : map.pixels()) {
    if (!(is_finite(s) && s.r >= 0 && s.g >= 0 && s.b >= 0)) {
      ++repairs.invalid;
      for (int c = 0; c < 3; ++c) s[c] = std::isfinite(s[c]) ? std::max(s[c], 0.0f) : 0.0f;
    }
    light = light || !s.is_black();
  }
  repairs.black = !light;
  return repairs;
}

Vec2 direction_to_uv(const MapOrientation& orientation, const Vec3& d) {
  // Turning the map counter-clockwise by `rotation` adds to the azimuth at which a texel is seen.
  const float turns = turns_of(d.x, -d.z) + orientation.rotation * (0.5f * kInvPi);
  const float u = orientation.mirrored ? 0.75f - turns : turns;
  const float v = 2 * turns_of(std::sqrt(square(d.x) + square(d.z)), d.y);  // acos(y), precise at the poles
  return {std::min(u - std::floor(u), kOneMinusEpsilon), std::min(v, kOneMinusEpsilon)};
}

Vec3 uv_to_direction(const MapOrientation& orientation, Vec2 uv) {
  const float turns = orientation.mirrored ? 0.75f - uv.x : uv.x;
  const SinCos azimuth = sin_cos_of_turns(turns - orientation.rotation * (0.5f * kInvPi));
  const SinCos theta = sin_cos_of_turns(0.5f * uv.y);
  return {theta.sin * azimuth.sin, theta.cos, -theta.sin * azimuth.cos};
}

Spectrum lookup_bilinear(const Image& map, Vec2 uv, MapRows rows) {
  const int w = map.width(), h = map.height();
  const float x = uv.x * static_cast<float>(w) - 0.5f;
  const float y = rows == MapRows::centered ? uv.y * static_cast<float>(h) - 0.5f : uv.y * static_cast<float>(h - 1);
  const int ix = static_cast<int>(x + 1) - 1, iy = static_cast<int>(y + 1) - 1;  // both are at least −½
  const int x0 = ix < 0 ? w - 1 : ix, x1 = ix + 1 == w ? 0 : ix + 1;
  const int y0 = std::max(iy, 0), y1 = std::min(iy + 1, h - 1);
  const float dx = x - static_cast<float>(ix), dy = y - static_cast<float>(iy);
  return (map.at(x0, y0) * (1 - dx) + map.at(x1, y0) * dx) * (1 - dy) +
         (map.at(x0, y1) * (1 - dx) + map.at(x1, y1) * dx) * dy;
}

}  // namespace etendue
