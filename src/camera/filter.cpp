#include "camera/filter.h"

#include <algorithm>
#include <cmath>

namespace etendue {
namespace {

constexpr float kMostRadius = 16;
/// Cells of equal probability; what a cell's constant density lacks goes into its weight, so that no picture is biased
/// by their number.
constexpr int kCells = 1 << 10;
/// Steps of the integral from which the cells are made.
constexpr int kSteps = 1 << 16;

/// Mitchell and Netravali 1988, eq. 8.
float cubic(float x, float b, float c) {
  x = std::abs(x);
  if (x >= 2) return 0;
  if (x < 1) return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
  return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) / 6;
}

float sinc(float x) {
  const float px = kPi * x;
  return std::abs(px) < 1e-4f ? 1.0f : std::sin(px) / px;
}

}  // namespace

float PixelFilter::value(const scene::ReconstructionFilter& filter, float x) {
  switch (filter.kind) {
    case scene::FilterKind::box:
      return std::abs(x) <= filter.radius ? 1.0f : 0.0f;
    case scene::FilterKind::tent:
      return std::max(0.0f, 1 - std::abs(x) / filter.radius);
    case scene::FilterKind::gaussian: {
      const float sigma = filter.radius / 4;
      return std::max(0.0f, std::exp(-0.5f * square(x / sigma)) - std::exp(-8.0f));
    }
    case scene::FilterKind::mitchell:
      return cubic(2 * x / filter.radius, filter.b, filter.c);
    case scene::FilterKind::catmull_rom:
      return cubic(2 * x / filter.radius, 0, 0.5f);
    case scene::FilterKind::lanczos:
      return std::abs(x) < filter.radius ? sinc(x) * sinc(x / filter.radius) : 0.0f;
  }
  return 0;
}

PixelFilter::PixelFilter(const scene::ReconstructionFilter& filter)
    : radius_(filter.radius > 0 ? std::min(filter.radius, kMostRadius) : 0.5f) {
  if (filter.kind == scene::FilterKind::box) return;
  scene::ReconstructionFilter reasonable = filter;
  reasonable.radius = radius_;
  // Cumulative integrals of the filter and of its absolute value, by the midpoint rule.
  const double step = 2.0 * radius_ / kSteps;
  std::vector<double> absolute(kSteps + 1), signed_sum(kSteps + 1);
  for (int i = 0; i < kSteps; ++i) {
    const double f = value(reasonable, static_cast<float>(-radius_ + (i + 0.5) * step));
    absolute[i + 1] = absolute[i] + std::abs(f) * step;
    signed_sum[i + 1] = signed_sum[i] + f * step;
  }
  const double total = absolute.back(), integral = signed_sum.back();
  const auto place = [&](double share) {  // where the absolute integral reaches this share
    const auto above = std::ranges::upper_bound(absolute, share * total);
    const auto i = std::clamp<std::ptrdiff_t>(above - absolute.begin() - 1, 0, kSteps - 1);
    const double within =
        absolute[i + 1] > absolute[i] ? (share * total - absolute[i]) / (absolute[i + 1] - absolute[i]) : 0;
    return static_cast<double>(i) + std::clamp(within, 0.0, 1.0);
  };
  const auto signed_at = [&](double x) {
    const auto i = std::min(static_cast<int>(x), kSteps - 1);
    return std::lerp(signed_sum[i], signed_sum[i + 1], x - i);
  };
  for (int c = 0; c < kCells; ++c) {
    const double from = c == 0 ? 0 : place(static_cast<double>(c) / kCells);
    const double to = c == kCells - 1 ? kSteps : place(static_cast<double>(c + 1) / kCells);
    cells_.push_back({static_cast<float>(-radius_ + from * step), static_cast<float>((to - from) * step),
                      static_cast<float>((signed_at(to) - signed_at(from)) / integral * kCells)});
  }
}

bool PixelFilter::has_negative_lobes() const {
  return std::ranges::any_of(cells_, [](const Cell& cell) { return cell.weight < 0; });
}

float PixelFilter::sample_axis(float u, float& weight) const {
  const float scaled = u * kCells;
  const int index = std::min(static_cast<int>(scaled), kCells - 1);
  const Cell& cell = cells_[index];
  weight *= cell.weight;
  return cell.begin + (scaled - static_cast<float>(index)) * cell.width;
}

PixelFilter::Sample PixelFilter::sample(Vec2 u) const {
  if (is_box()) return {{(2 * u.x - 1) * radius_, (2 * u.y - 1) * radius_}, 1};
  Sample sample{{0, 0}, 1};
  sample.offset.x = sample_axis(u.x, sample.weight);
  sample.offset.y = sample_axis(u.y, sample.weight);
  return sample;
}

}  // namespace etendue
