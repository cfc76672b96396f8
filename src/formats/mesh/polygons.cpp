#include "formats/mesh/polygons.h"

#include <algorithm>
#include <cmath>

namespace etendue {
namespace {

constexpr std::size_t kMostCornersToClip = 1024;  ///< clipping takes quadratic time

struct Point2d {
  double x = 0, y = 0;
};

/// Twice the signed area of a triangle.
double area2(const Point2d& a, const Point2d& b, const Point2d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Twice the vector area of a polygon (Newell's method).
Vec3d vector_area2(std::span<const Point3> corners) {
  const Vec3d origin(corners[0]);
  Vec3d sum(0);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += (Vec3d(corners[i]) - origin).cross(Vec3d(corners[i + 1]) - origin);
  return sum;
}

/// The polygon seen along the largest component of its normal, so that it is wound counter-clockwise.
std::vector<Point2d> projected(std::span<const Point3> corners, const Vec3d& normal) {
  const int axis = std::abs(normal.x) > std::abs(normal.y) ? (std::abs(normal.x) > std::abs(normal.z) ? 0 : 2)
                                                           : (std::abs(normal.y) > std::abs(normal.z) ? 1 : 2);
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);
  std::vector<Point2d> flat;
  flat.reserve(corners.size());
  for (const Point3& p : corners) flat.push_back({p[u], p[v]});
  return flat;
}

/// A polygon that loses one ear after the other.
class EarClipper {
 public:
  explicit EarClipper(std::vector<Point2d> points) : points_(std::move(points)), corners_(points_.size()) {
    const auto n = static_cast<std::uint32_t>(points_.size());
    for (std::uint32_t i = 0; i < n; ++i) corners_[i] = {(i + n - 1) % n, (i + 1) % n, false};
  }

  Triangulation run() {
    Triangulation result;
    std::uint32_t current = 0;
    mark_all_ears(current);
    for (std::size_t left = points_.size(); left > 3; --left) {
      std::uint32_t ear = find_ear(current, left);
      if (!corners_[ear].is_ear) {  // clipping may have freed a corner that is no neighbour of an ear
        mark_all_ears(current);
        ear = find_ear(current, left);
      }
      if (!corners_[ear].is_ear) result.is_simple = false;
      result.triangles.push_back({corners_[ear].previous, ear, corners_[ear].next});
      current = remove(ear);
    }
    result.triangles.push_back({corners_[current].previous, current, corners_[current].next});
    if (turn(current) < 0) result.is_simple = false;
    return result;
  }

 private:
  struct Corner {
    std::uint32_t previous = 0, next = 0;
    bool is_ear = false;
  };

  double turn(std::uint32_t i) const {
    return area2(points_[corners_[i].previous], points_[i], points_[corners_[i].next]);
  }

  /// Convex, and no reflex corner lies in the triangle that would be cut off.
  bool is_ear(std::uint32_t i) const {
    if (turn(i) <= 0) return false;
    const Point2d &a = points_[corners_[i].previous], &b = points_[i], &c = points_[corners_[i].next];
    for (std::uint32_t j = corners_[corners_[i].next].next; j != corners_[i].previous; j = corners_[j].next) {
      const Point2d& p = points_[j];
      const bool inside = area2(a, b, p) >= 0 && area2(b, c, p) >= 0 && area2(c, a, p) >= 0;
      if (inside && turn(j) <= 0) return false;
    }
    return true;
  }

  void mark_all_ears(std::uint32_t start) {
    std::uint32_t i = start;
    do {
      corners_[i].is_ear = is_ear(i);
      i = corners_[i].next;
    } while (i != start);
  }

  /// The first ear from `start` on, or `start` if there is none.
  std::uint32_t find_ear(std::uint32_t start, std::size_t left) const {
    std::uint32_t i = start;
    for (std::size_t tried = 0; tried < left && !corners_[i].is_ear; ++tried) i = corners_[i].next;
    return i;
  }

  /// Returns the corner after the removed one.
  std::uint32_t remove(std::uint32_t i) {
    const auto [previous, next, was_ear] = corners_[i];
    corners_[previous].next = next;
    corners_[next].previous = previous;
    corners_[previous].is_ear = is_ear(previous);
    corners_[next].is_ear = is_ear(next);
    return next;
  }

  std::vector<Point2d> points_;
  std::vector<Corner> corners_;
};

Triangulation fan(std::size_t corner_count, bool is_simple) {
  Triangulation result;
  result.is_simple = is_simple;
  result.triangles.reserve(corner_count - 2);
  for (std::uint32_t i = 1; i + 1 < corner_count; ++i) result.triangles.push_back({0, i, i + 1});
  return result;
}

/// No corner turns against the polygon's normal.
bool turns_one_way(std::span<const Point3> corners, const Vec3d& normal) {
  const std::size_t n = corners.size();
  const double tolerance = -1e-9 * normal.dot(normal);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d before = Vec3d(corners[(i + 1) % n]) - Vec3d(corners[i]);
    const Vec3d after = Vec3d(corners[(i + 2) % n]) - Vec3d(corners[(i + 1) % n]);
    if (before.cross(after).dot(normal) < tolerance) return false;
  }
  return true;
}

/// No triangle of its fan turns against the polygon's normal: with corners that turn one way, the outline runs around
/// once.
bool fan_turns_one_way(std::span<const Point3> corners, const Vec3d& normal) {
  const Vec3d origin(corners[0]);
  const double tolerance = -1e-9 * normal.dot(normal);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    if ((Vec3d(corners[i]) - origin).cross(Vec3d(corners[i + 1]) - origin).dot(normal) < tolerance) return false;
  return true;
}

}  // namespace

Triangulation triangulate(std::span<const Point3> corners) {
  const Vec3d normal = vector_area2(corners);
  const bool encloses_area = normal.length2() > 0;
  if (corners.size() == 3) return fan(3, encloses_area);
  if (turns_one_way(corners, normal)) return fan(corners.size(), encloses_area && fan_turns_one_way(corners, normal));
  if (corners.size() > kMostCornersToClip) return fan(corners.size(), false);
  return EarClipper(projected(corners, normal)).run();
}

bool has_no_area(const Point3& a, const Point3& b, const Point3& c) {
  const Vec3d ab = Vec3d(b) - Vec3d(a), ac = Vec3d(c) - Vec3d(a), bc = Vec3d(c) - Vec3d(b);
  const double longest2 = std::max({ab.dot(ab), ac.dot(ac), bc.dot(bc)});
  const Vec3d area = ab.cross(ac);
  return !(area.dot(area) > 1e-20 * longest2 * longest2);
}

Vec3 unit_or_zero(const Vec3& v) {
  const Vec3 unit = normalize(v);
  return length_squared(unit) > 0.5f ? unit : Vec3(0);
}

}  // namespace etendue
