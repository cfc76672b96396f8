#include "lights/light.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "light_kit.h"
#include "testing/quadrature.h"
#include "testing/sphere_grid.h"

/// Every light of the list is tested for all that lights promise; a new one is told of by ListIsComplete until it
/// stands here.
namespace etendue {
namespace {

const Spectrum kRadiance(3, 2, 1);

/// A light and the points that it is looked at from.
struct NamedLight {
  std::string name;
  Light light;
  std::vector<Point3> places;
};

/// A spot light that shines down.
SpotLight lamp(const Point3& position, float cutoff, float beam, float exponent) {
  SpotLight light;
  light.frame = Transform::rotation({1, 0, 0}, -kPi / 2);
  light.frame.origin = position;
  light.intensity = kRadiance;
  light.cutoff = cutoff;
  light.beam = beam;
  light.exponent = exponent;
  return light;
}

/// The map's axes turned away from the world's.
EnvironmentLight turned(EnvironmentLight light) {
  light.axes = Frame::from_normal(normalize(Vec3(1, 2, 3)));
  light.turned = true;
  return light;
}

std::vector<NamedLight> all_lights() {
  // In front of the unit square at y = 0 that shines downwards: far and near, on both sides of where sampling changes
  // from area to solid angle, at grazing angles, and behind.
  const std::vector<Point3> below_square = {
      {0, -30, 0},          {0, -1.45f, 0},   {0, -1.38f, 0},       {1, -1, 2},     {0.2f, -0.1f, 0},
      {0.4f, -0.01f, 0.3f}, {0, -0.0005f, 0}, {1.5f, -0.05f, 0.2f}, {3, -0.01f, 1}, {0, 1, 0}};
  const Rectangle square_light({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 0, 1});
  const Rectangle strip({-5, 0, -0.05f}, {10, 0, 0}, {0, 0, 0.1f});
  const Vec3 x = normalize(Vec3(1, 2, 2)), y = normalize(cross(x, Vec3(0.3f, -1, 0.5f)));
  const Rectangle tilted(Point3(3, -1, 7), x * 0.7f, y * 2);
  const Vec3 n = tilted.normal;
  const MeshLight::Triangle one = triangle({0, 0, 0}, {1, 0, 0}, {0, 0, 2});  // shines down, as the rectangles do
  return {
      {"point", PointLight{{1, 2, 3}, kRadiance}, {{0, 0, 0}, {1, 2, 2.99f}}},
      {"spot", lamp({0, 5, 0}, std::acos(0.8f), 0.3f, 4), {{0, 0, 0}, {1, 1, 0}}},
      {"projector", ProjectorLight{lamp({0, 5, 0}, 1, 1, 0).frame, 1, 0.5f, 1, kRadiance}, {{0, 0, 0}, {1, 1, 0}}},
      {"directional", DirectionalLight{normalize(Vec3(1, 2, 3)), kRadiance}, {{0, 0, 0}, {100, 0, 0}}},
      {"square", RectangleLight{square_light, kRadiance}, below_square},
      {"strip",
       RectangleLight{strip, kRadiance},
       {{0, -20, 0}, {0, -1, 0}, {0, -0.1f, 0}, {0, -0.02f, 0}, {4.9f, -0.3f, 1}, {-7, -0.2f, 0.1f}}},
      {"tilted rectangle",
       RectangleLight{tilted, kRadiance},
       {tilted.center() + n * 10, tilted.center() + n + x, tilted.center() + n * 0.1f - y, tilted.center() - n}},
      {"triangle",
       MeshLight({one}, kRadiance),
       {{0, -30, 0},
        {0.3f, -2.8f, 0.6f},
        {0.3f, -2.2f, 0.6f},
        {0.3f, -0.1f, 0.3f},
        {0.4f, -0.02f, 0.5f},
        {0.2f, -0.005f, 0.2f},
        {1.5f, -0.1f, 1},
        {2, -0.03f, 0},
        {0, 1, 0}}},
      {"cube of triangles",
       MeshLight(cube(), kRadiance),
       {{9, 3, 4}, {2, 0.3f, 0.1f}, {0.7f, 0.8f, 0.9f}, {0.55f, 0.1f, 0.2f}, {0, 0, 0}}},
      {"triangles of all sizes",
       MeshLight(
           {one, triangle({0, -1, 0}, {0.01f, -1, 0}, {0, -1, 0.01f}), triangle({-5, 1, -5}, {5, 1, -5}, {0, 2, 5})},
           kRadiance),
       {{0, -5, 0}, {0.2f, -0.5f, 0.2f}, {0, -1.02f, 0}}},
      {"sphere",
       SphereLight{{1, 2, 3}, 1, kRadiance},
       {{1, 2, 100}, {1, 2, 5}, {1, 3.1f, 3}, {1.6f, 2.8f, 3.1f}, {1, 2, 4.0001f}, {1.2f, 2, 3}}},
      {"small sphere", SphereLight{{1, 2, 3}, 1e-3f, kRadiance}, {{1, 2, 0}, {1, 2, 3.01f}, {11, 2, 3}}},
      {"hemisphere", UniformLight{kRadiance, true}, {{0, 0, 0}}},
      {"sky all around", UniformLight{kRadiance}, {{0, 0, 0}}},
      {"turned box of light", turned(environment(8, 4, true, {})), {{0, 0, 0}}},
      {"map", environment(8, 4, true, {}), {{0, 0, 0}}},
      {"turned map", environment(7, 5, true, {1, false}), {{0, 0, 0}}},
      {"mirrored, turned map", environment(8, 4, true, {2, true}), {{0, 0, 0}}},
      {"map, sampled uniformly", environment(8, 4, false, {0.3f, false}), {{0, 0, 0}}},
  };
}

std::string at(const NamedLight& named, const Point3& from) {
  std::ostringstream out;
  out << named.name << " seen from " << from;
  return out.str();
}

TEST(Light, ListIsComplete) {
  std::set<std::size_t> alternatives;
  for (const NamedLight& named : all_lights()) alternatives.insert(named.light.index());
  // Those that know their shape from the geometry are tested in glow_test.cpp.
  EXPECT_EQ(alternatives.size(), std::variant_size_v<Light> - 2) << "a light is missing in all_lights()";
}

// --- Where directions meet lights, in doubles, by other means than the lights'
// ---------------------------------------------

struct Crossing {
  LightHit hit;
  double distance;
};

/// A parallelogram (or half of one, with `triangle`) met by the ray from its front.
std::optional<Crossing> cross_front(const Point3& corner, const Vec3& edge_x, const Vec3& edge_y, const Vec3& normal,
                                    bool triangle, const Point3& from, const Vec3& wi) {
  const Vec3d o(from), d(wi), e1(edge_x), e2(edge_y), s = o - Vec3d(corner);
  if (d.dot(Vec3d(normal)) >= 0) return std::nullopt;
  const Vec3d h = d.cross(e2), q = s.cross(e1);
  const double a = e1.dot(h), u = s.dot(h) / a, v = d.dot(q) / a, t = e2.dot(q) / a;
  if (!(t > 0) || u < 0 || v < 0 || (triangle ? u + v > 1 : u > 1 || v > 1)) return std::nullopt;
  return Crossing{{Point3(o + d * t), normal}, t};
}

std::vector<Crossing> crossings(const Light& light, const Point3& from, const Vec3& wi) {
  std::vector<Crossing> out;
  const auto add = [&](std::optional<Crossing> crossing, std::uint32_t primitive) {
    if (!crossing) return;
    crossing->hit.primitive = primitive;
    out.push_back(*crossing);
  };
  if (const auto* rectangle = std::get_if<RectangleLight>(&light)) {
    const Rectangle& r = rectangle->rectangle;
    add(cross_front(r.corner, r.edge_x, r.edge_y, r.normal, false, from, wi), 0);
  } else if (const auto* mesh = std::get_if<MeshLight>(&light)) {
    for (std::uint32_t i = 0; i < mesh->triangles.size(); ++i) {
      const MeshLight::Triangle& t = mesh->triangles[i];
      add(cross_front(t.p0, t.p1 - t.p0, t.p2 - t.p0, t.normal, true, from, wi), i);
    }
  } else if (const auto* sphere = std::get_if<SphereLight>(&light)) {
    const Vec3d o(from), d(wi), to_center = Vec3d(sphere->center) - o;
    const double along = to_center.dot(d) / d.length(), off2 = (d.cross(to_center) / d.length()).length2();
    const double r2 = square(sphere->radius), t = along - std::sqrt(std::max(r2 - off2, 0.0));
    if (off2 <= r2 && t > 0) {
      const Point3 p(o + d * t);
      out.push_back({{p, normalize(p - sphere->center)}, t});
    }
  }
  return out;
}

// --- Cells over what a light is sampled by: its surface, or the directions to it
// ------------------------------------------

struct Cells {
  std::vector<double> expected;  ///< probability of each by the light's density, integrated over it
  std::function<std::size_t(const LightSample&)> cell_of;
};

/// A flat piece of a light: a parallelogram, or the triangle that is half of it.
struct Patch {
  Point3 corner;
  Vec3 edge_x, edge_y, normal;
  bool triangle;
};

std::vector<Patch> patches_of(const Light& light) {
  if (const auto* rectangle = std::get_if<RectangleLight>(&light)) {
    const Rectangle& r = rectangle->rectangle;
    return {{r.corner, r.edge_x, r.edge_y, r.normal, false}};
  }
  std::vector<Patch> patches;
  if (const auto* mesh = std::get_if<MeshLight>(&light))
    for (const MeshLight::Triangle& t : mesh->triangles)
      patches.push_back({t.p0, t.p1 - t.p0, t.p2 - t.p0, t.normal, true});
  return patches;
}

/// Position of `p` in its patch: the shares of the two edges, made a square for a triangle, too.
struct PatchPoint {
  double x, y, off_plane;
};
PatchPoint locate(const Patch& patch, const Point3& p) {
  const Vec3d e1(patch.edge_x), e2(patch.edge_y), n(patch.normal), d = Vec3d(p) - Vec3d(patch.corner);
  const double volume = e1.cross(e2).dot(n), u = d.cross(e2).dot(n) / volume, v = e1.cross(d).dot(n) / volume;
  return {u, patch.triangle && u < 1 ? v / (1 - u) : v, std::abs(d.dot(n))};
}

/// kSide² cells on each patch.
Cells surface_cells(const Light& light, const Point3& from) {
  constexpr int kSide = 12;
  const std::vector<Patch> patches = patches_of(light);
  Cells cells;
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    const Patch& patch = patches[i];
    const auto density = [&](double x, double y) {
      const double edge = patch.triangle ? 1 - x : 1.0;
      const Vec3d position = Vec3d(patch.corner) + Vec3d(patch.edge_x) * x + Vec3d(patch.edge_y) * (y * edge);
      const Vec3d to_light = position - Vec3d(from), area = Vec3d(patch.edge_x).cross(Vec3d(patch.edge_y));
      const double d2 = to_light.length2(), cosine = -to_light.dot(Vec3d(patch.normal)) / std::sqrt(d2);
      if (cosine <= 0) return 0.0;
      return whole_pdf(light, from, {Point3(position), patch.normal, i}) * cosine / d2 * area.length() * edge;
    };
    for (int row = 0; row < kSide; ++row)
      for (int column = 0; column < kSide; ++column)
        cells.expected.push_back(
            integrate(density,
                      Box2{static_cast<double>(column) / kSide, static_cast<double>(column + 1) / kSide,
                           static_cast<double>(row) / kSide, static_cast<double>(row + 1) / kSide},
                      1e-7));
  }
  cells.cell_of = [patches, from](const LightSample& s) {
    const Point3 p = from + s.wi * s.distance;
    std::size_t nearest = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const PatchPoint at = locate(patches[i], p);
      const double beside = std::max({-at.x, at.x - 1, -at.y, at.y - 1, 0.0}) + at.off_plane;
      if (dot(s.wi, patches[i].normal) < 0 && beside < distance) {
        distance = beside;
        nearest = i;
      }
    }
    const PatchPoint at = locate(patches[nearest], p);
    const auto index = [](double x) {
      return static_cast<std::size_t>(std::clamp(static_cast<int>(x * kSide), 0, kSide - 1));
    };
    return (nearest * kSide + index(at.y)) * kSide + index(at.x);
  };
  return cells;
}

/// The directions to a light that is round about `axis`, up to the angle whose half has the tangent `focus`.
Cells round_cells(const Light& light, const Point3& from, const Vec3& axis, double focus) {
  const SphereGrid grid(axis, focus);
  const auto density = [&](const Vec3& w) {
    if (is_infinite(light)) return static_cast<double>(look_at_infinity(light, w).pdf);
    const std::vector<Crossing> found = crossings(light, from, w);
    return found.empty() ? 0.0 : static_cast<double>(whole_pdf(light, from, found[0].hit));
  };
  return {grid.integrals(density, 1e-5), [grid](const LightSample& s) { return grid.cell(s.wi); }};
}

/// 3 × 3 cells to each cell of a map's distribution.
Cells map_cells(const EnvironmentLight& light) {
  const int columns = 3 * light.distribution.width(), rows = 3 * light.distribution.height();
  const auto density = [&](double u, double v) {
    const Vec3 w = uv_to_direction(light.orientation, {static_cast<float>(u), static_cast<float>(v)});
    return light.look(light.turned ? light.axes.to_world(w) : w).pdf * 2 * std::numbers::pi * std::numbers::pi *
           std::sin(std::numbers::pi * v);
  };
  Cells cells;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      cells.expected.push_back(
          integrate(density,
                    Box2{static_cast<double>(column) / columns, static_cast<double>(column + 1) / columns,
                         static_cast<double>(row) / rows, static_cast<double>(row + 1) / rows},
                    1e-7));
  cells.cell_of = [columns, rows, orientation = light.orientation, axes = light.axes,
                   turned = light.turned](const LightSample& s) {
    const Vec2 uv = direction_to_uv(orientation, turned ? axes.to_local(s.wi) : s.wi);
    return static_cast<std::size_t>(uv.y * static_cast<float>(rows)) * columns +
           static_cast<std::size_t>(uv.x * static_cast<float>(columns));
  };
  return cells;
}

Cells cells_of(const Light& light, const Point3& from) {
  if (const auto* map = std::get_if<EnvironmentLight>(&light)) return map_cells(*map);
  if (std::holds_alternative<UniformLight>(light)) return round_cells(light, from, {0, 1, 0}, 1);
  if (const auto* sphere = std::get_if<SphereLight>(&light)) {
    const Vec3 to_center = sphere->center - from;
    const double sine = std::min(1.0, static_cast<double>(sphere->radius) / length(to_center));
    return round_cells(light, from, normalize(to_center), sine / (1 + std::sqrt(1 - sine * sine)));
  }
  return surface_cells(light, from);
}

// --- What all lights promise
// -------------------------------------------------------------------------------------------

TEST(Light, SamplesFollowTheDensity) {
  TestFamily family;
  constexpr int kSamples = 40000;
  for (const NamedLight& named : all_lights()) {
    if (is_delta(named.light)) continue;
    for (const Point3& from : named.places) {
      Cells cells = cells_of(named.light, from);
      const double share = std::accumulate(cells.expected.begin(), cells.expected.end(), 0.0);
      EXPECT_LE(share, 1 + 2e-3) << at(named, from);
      cells.expected.push_back(std::max(1 - share, 0.0));  // no sample
      std::vector<double> counts(cells.expected.size());
      Random random(1);
      for (int i = 0; i < kSamples; ++i) {
        const std::optional<LightSample> s = sample_whole(named.light, from, random.point(), random.value());
        ++counts[s ? cells.cell_of(*s) : counts.size() - 1];
      }
      EXPECT_NEAR(1 - counts.back() / kSamples, share, 0.012) << at(named, from);
      for (double& e : cells.expected) e *= kSamples;
      family.add(at(named, from), chi_square_test(counts, cells.expected).p);
    }
  }
  EXPECT_TRUE(family.holds());
}

TEST(Light, SamplesLieOnTheLightAndKnowTheirDensity) {
  for (const NamedLight& named : all_lights()) {
    if (is_delta(named.light)) continue;
    for (const Point3& from : named.places) {
      Random random(2);
      int samples = 0, beside = 0;
      for (int i = 0; i < 2000; ++i) {
        const std::optional<LightSample> s = sample_whole(named.light, from, random.point(), random.value());
        if (!s) continue;
        ++samples;
        ASSERT_FALSE(s->is_delta);
        ASSERT_NEAR(length(s->wi), 1, 1e-5f) << at(named, from);
        ASSERT_TRUE(s->pdf > 0 && std::isfinite(s->pdf)) << at(named, from);
        if (is_infinite(named.light)) {
          EXPECT_TRUE(std::isinf(s->distance));
          // A direction next to a texel's edge may be found in the next texel.
          const double pdf = look_at_infinity(named.light, s->wi).pdf;
          if (std::abs(pdf / s->pdf - 1) > 1e-3) ++beside;
          for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(s->radiance[c], look_at_infinity(named.light, s->wi).radiance[c], 1e-4f * (1 + s->radiance[c]))
                << at(named, from);
          continue;
        }
        EXPECT_EQ(s->radiance, kRadiance);
        // The nearest of the crossings at the sample's distance; none if the sample is at the very edge.
        const Crossing* found = nullptr;
        const std::vector<Crossing> all = crossings(named.light, from, s->wi);
        for (const Crossing& c : all)
          if (found == nullptr || std::abs(c.distance - s->distance) < std::abs(found->distance - s->distance))
            found = &c;
        if (found == nullptr) {
          ++beside;
          continue;
        }
        // Shadow rays stop 1e-4 before the light. At a sphere's rim a direction's rounding moves the point, along the
        // surface.
        const bool rim = std::holds_alternative<SphereLight>(named.light) && dot(found->hit.normal, s->wi) > -0.05f;
        ASSERT_NEAR(s->distance / found->distance, 1, rim ? 3e-3 : 6e-5) << at(named, from);
        ASSERT_NEAR(whole_pdf(named.light, from, found->hit) / s->pdf, 1, 5e-3) << at(named, from);
      }
      EXPECT_LE(beside, samples / 100) << at(named, from);
    }
  }
}

TEST(Light, IsNeverNan) {
  const float kEnds[] = {0, 0x1p-24f, 0.5f, kOneMinusEpsilon};
  for (const NamedLight& named : all_lights()) {
    std::vector<Point3> places = named.places;
    // On the light, in its plane, at its corner and middle, very near and very far.
    for (const Point3& p : {Point3(0, 0, 0), Point3(-0.5f, 0, -0.5f), Point3(2, 0, 2), Point3(0.1f, -1e-10f, 0),
                            Point3(1, 2, 3), Point3(1, 2, 4), Point3(1e10f, -1e10f, 1e10f)})
      places.push_back(p);
    for (const Point3& from : places)
      for (const float u : kEnds)
        for (const float v : kEnds) {
          const std::optional<LightSample> s = sample_whole(named.light, from, {u, v}, v);
          if (!s) continue;
          EXPECT_TRUE(is_finite(s->wi) && is_finite(s->radiance) && std::isfinite(s->pdf) && s->pdf > 0)
              << at(named, from) << ' ' << u << ' ' << v;
          EXPECT_GE(s->distance, 0) << at(named, from);
        }
  }
}

TEST(Light, KindsAreConsistent) {
  for (const NamedLight& named : all_lights()) {
    EXPECT_GT(light_power(named.light, kScene), 0) << named.name;
    EXPECT_TRUE(std::isfinite(light_power(named.light, kScene))) << named.name;
    std::optional<LightSample> s;
    for (int i = 0; i < 16 && !s; ++i)
      s = sample_whole(named.light, named.places[0], {0.5f, 0.5f}, (static_cast<float>(i) + 0.5f) / 16);
    ASSERT_TRUE(s) << named.name;
    EXPECT_EQ(s->is_delta, is_delta(named.light)) << named.name;
    if (is_delta(named.light)) {
      EXPECT_EQ(s->pdf, 1) << named.name;
      EXPECT_EQ(whole_pdf(named.light, {0, 0, 0}, {}), 0) << named.name;
      EXPECT_EQ(look_at_infinity(named.light, s->wi).pdf, 0) << named.name;
    }
    if (!is_infinite(named.light)) {
      EXPECT_TRUE(look_at_infinity(named.light, {0, 1, 0}).radiance.is_black()) << named.name;
    }
  }
}

}  // namespace
}  // namespace etendue
