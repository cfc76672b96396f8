#include "media/airlight.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace etendue {
namespace {

bool is_grey(const Spectrum& s) {
  return s.r == s.g && s.g == s.b;
}

/// e^(−σ x), also where x is infinite.
Spectrum dimmed(const Spectrum& sigma, double x) {
  const auto one = [length = static_cast<float>(x)](float s) { return s == 0 ? 1.0f : std::exp(-s * length); };
  return is_grey(sigma) ? Spectrum(one(sigma.r)) : Spectrum(one(sigma.r), one(sigma.g), one(sigma.b));
}

float sum(const Spectrum& s) {
  return s.r + s.g + s.b;
}

Vec3d as_double(const Vec3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

std::optional<Ray> within_cone(const Ray& ray, const Point3& apex, const Vec3& axis, float cos_angle) {
  if (cos_angle < 0) return ray;
  // A point is in the cone or its mirror image where (o·a + t d·a)² ≥ cos² |o + t d|²: a t² + 2 b t + c ≥ 0.
  const Vec3d o = as_double(ray.origin) - as_double(apex), d = as_double(ray.direction), axis_d = as_double(axis);
  const double height = o.dot(axis_d), rise = d.dot(axis_d), cos2 = double{cos_angle} * cos_angle;
  const double a = rise * rise - cos2 * d.length2(), b = height * rise - cos2 * o.dot(d);
  const double c = height * height - cos2 * o.length2();
  const double discriminant = b * b - a * c;
  constexpr double kNearlyParallel = 1e-9;  // to the cone's side
  if (std::abs(a) < kNearlyParallel) return ray;
  if (discriminant < 0 && a < 0) return std::nullopt;
  const double q = -(b + std::copysign(std::sqrt(std::max(discriminant, 0.0)), b));
  const double r0 = q / a, r1 = q == 0 ? 0 : c / q;
  const double first = std::min(r0, r1), last = std::max(r0, r1);
  Ray inside = ray;
  const auto keep = [&inside](double begin, double end) {
    inside.t_min = static_cast<float>(std::max<double>(inside.t_min, begin));
    inside.t_max = static_cast<float>(std::min<double>(inside.t_max, end));
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (a < 0) {
    if (height + 0.5 * (first + last) * rise <= 0) return std::nullopt;
    keep(first, last);
  } else if (rise > 0) {
    keep(last, kInfinity);
  } else {
    keep(-kInfinity, first);
  }
  if (!(inside.t_min < inside.t_max)) return std::nullopt;
  return inside;
}

SeenRay::SeenRay(const Ray& ray, const Point3& light) {
  const Vec3d to_light = as_double(light) - as_double(ray.origin), direction = as_double(ray.direction);
  nearest = to_light.dot(direction);
  constexpr double kRounding = 1e-6;
  const double least = kRounding * (max_abs_component(light) + max_abs_component(ray.origin)) + 1e-30;
  distance = std::max((to_light - direction * nearest).length(), least);
  begin_offset = ray.t_min - nearest;
  end_offset = ray.t_max - nearest;
  begin = std::atan(begin_offset / distance);
  end = std::atan(end_offset / distance);
}

double SeenRay::uniform_angle_pdf(double offset) const {
  if (!(offset >= begin_offset && offset <= end_offset)) return 0;
  return distance / ((distance * distance + offset * offset) * (end - begin));
}

AirlightDistances::AirlightDistances(const Medium& medium, const Ray& ray, const SeenRay& seen,
                                     const Spectrum& throughput)
    : seen_(seen) {
  const Spectrum sigma = medium.extinction(ray.origin);
  add_equal_angles();
  const int angles = count_;
  add_depths(sigma.max());
  const auto knots = std::span(knots_).first(count_);
  std::inplace_merge(knots.begin(), knots.begin() + angles, knots.end(),
                     [](const Knot& a, const Knot& b) { return a.offset < b.offset; });
  const double closest = seen.to_light(std::clamp(0.0, seen.begin_offset, seen.end_offset));
  const Spectrum scattered = throughput * sigma;
  for (Knot& knot : knots) {
    const double d = seen.to_light(knot.offset);
    const float sine = std::isinf(d) ? 1.0f : static_cast<float>(knot.offset / d);
    const Vec3 wi(static_cast<float>(seen.distance / d), 0, -sine);  // the ray runs along z
    const Spectrum arriving = dimmed(sigma, d - closest) + Spectrum(kUndimmed);
    knot.value = eval_phase(medium.phase(), {0, 0, -1}, wi) *
                 sum(scattered * arriving * dimmed(sigma, knot.offset - seen.begin_offset));
  }
  for (int i = 0; i + 1 < count_; ++i)
    total_ += 0.5 * (knots_[i].value + knots_[i + 1].value) * (knots_[i + 1].angle - knots_[i].angle);
}

/// Turns from one to the next, which costs no more trigonometric functions.
void AirlightDistances::add_equal_angles() {
  const double step = (seen_.end - seen_.begin) / kSteps;
  const double sine = std::sin(step), cosine = std::cos(step);
  double s = std::sin(seen_.begin), c = std::cos(seen_.begin);
  knots_[count_++] = {seen_.begin_offset, seen_.begin};
  for (int i = 1; i < kSteps; ++i) {
    s = std::exchange(c, c * cosine - s * sine) * sine + s * cosine;
    knots_[count_++] = {std::clamp(seen_.distance * s / c, seen_.begin_offset, seen_.end_offset),
                        seen_.begin + i * step};
  }
  knots_[count_++] = {seen_.end_offset, seen_.end};
}

void AirlightDistances::add_depths(float max_extinction) {
  double depth = kFirstDepth / max_extinction;
  for (int i = 0; i < kDepths; ++i, depth *= 2) {
    const double offset = seen_.begin_offset + depth;
    if (!(offset < seen_.end_offset)) return;
    knots_[count_++] = {offset, std::atan(offset / seen_.distance)};
  }
}

std::optional<AirlightDistances::Sample> AirlightDistances::sample(float u) const {
  if (!(total_ > 0)) return std::nullopt;
  double rest = u * total_;
  for (int i = 0; i + 1 < count_; ++i) {
    const Knot &a = knots_[i], &b = knots_[i + 1];
    const double width = b.angle - a.angle, mass = 0.5 * (a.value + b.value) * width;
    if (rest >= mass) {
      rest -= mass;
      continue;
    }
    const double v = rest / mass, va = a.value, vb = b.value;
    const double s = v * (va + vb) / (va + std::sqrt((1 - v) * va * va + v * vb * vb));
    const double offset = std::clamp(seen_.distance * std::tan(a.angle + s * width), a.offset, b.offset);
    const double pdf =
        (va + (vb - va) * s) / total_ * seen_.distance / (seen_.distance * seen_.distance + offset * offset);
    if (!(pdf > 0)) return std::nullopt;
    return Sample{static_cast<float>(seen_.nearest + offset), static_cast<float>(pdf)};
  }
  return std::nullopt;
}

}  // namespace etendue
