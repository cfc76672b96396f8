#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "geometry/geometry.h"
#include "testing/random.h"

namespace etendue {
namespace {

/// A well-conditioned map of about the given size: rotation, three different scales, shear; mirrored if asked for.
Transform any_map(Random& random, float size, const Point3& origin, bool mirrored) {
  const Transform turn = Transform::rotation(random.direction(), random.between(0, 6));
  const Transform shear{
      {1, 0, 0}, {random.between(-0.5f, 0.5f), 1, 0}, {random.between(-0.5f, 0.5f), 0.2f, 1}, {0, 0, 0}};
  const float flip = mirrored ? -1.0f : 1.0f;
  const Transform scale = Transform::scaling(
      {size * random.between(0.5f, 2), flip * size * random.between(0.5f, 2), size * random.between(0.5f, 2)});
  return Transform::translation(origin) * turn * shear * scale;
}

CurvesShape random_curve(Random& random, CurvesShape::Basis basis, float size, const Point3& center, float thickness) {
  CurvesShape out{basis, {}, {}};
  const std::uint32_t used = basis == CurvesShape::Basis::linear ? 2 : 4;
  Vec3 direction = random.direction(), p(0);
  for (std::uint32_t i = 0; i < used + 3; ++i) {
    out.points.push_back({center + p * size, size * thickness * random.between(0.5f, 1)});
    if (i + 1 >= used) out.segments.push_back(i + 1 - used);
    direction = normalize(direction + random.direction() * 0.4f);
    p += direction * 0.4f;
  }
  return out;
}

/// A grid over a bent sheet, with smooth normals, texture coordinates and attributes.
TriangleMesh bent_sheet(int cells) {
  TriangleMesh mesh;
  MeshAttribute height{"vertex_height", false, 1, {}}, face{"face_color", true, 3, {}};
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(cells),
                  v = static_cast<float>(j) / static_cast<float>(cells);
      mesh.positions.push_back({2 * u - 1, 2 * v - 1, 0.3f * std::sin(3 * u) + 0.2f * v * v});
      mesh.normals.push_back(normalize(Vec3(-0.45f * std::cos(3 * u), -0.2f * v, 1)));
      mesh.uvs.push_back({3 * u + 0.5f * v, 2 * v});
      height.values.push_back(7 * u + v);
    }
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(j * (cells + 1) + i); };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    face.values.insert(face.values.end(), {static_cast<float>(t), 1, 2});
  mesh.attributes = {height, face};
  return mesh;
}

TriangleMesh transformed(TriangleMesh mesh, const Transform& m) {
  const float sign = m.determinant() < 0 ? -1.0f : 1.0f;
  for (Point3& p : mesh.positions) p = m.point(p);
  for (Vec3& n : mesh.normals) n = normalize(m.normal(n) * sign);
  if (sign < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

template <typename... Shapes>
Geometry built(Shapes... shapes) {
  Geometry geometry;
  (geometry.add(std::move(shapes)), ...);
  geometry.build();
  return geometry;
}

/// The shape as the only one of a group that is placed once.
template <typename Shape>
Geometry placed(Shape shape, const Transform& m) {
  Geometry geometry;
  const std::uint32_t group = geometry.begin_group();
  geometry.add(std::move(shape));
  geometry.end_group();
  geometry.add_instance(group, m);
  geometry.build();
  return geometry;
}

/// A ray to somewhere within `size` of the centre, from around it.
Ray ray_towards(Random& random, const Point3& center, float size) {
  const Point3 target = center + random.direction() * (size * random.value());
  const Point3 origin = center + random.direction() * (size * random.between(2, 5));
  return {origin, normalize(target - origin)};
}

float distance(const Vec3& a, const Vec3& b) {
  return length(a - b);
}

TEST(Instance, EqualsTheTransformedMesh) {
  Random random(1);
  for (int repetition = 0; repetition < 20; ++repetition) {
    const Transform m = any_map(random, 2, random.direction() * 3, repetition % 2 == 1);
    const Geometry instance = placed(bent_sheet(6), m), copy = built(transformed(bent_sheet(6), m));
    int hits = 0, different = 0;
    for (int i = 0; i < 500; ++i) {
      const Ray ray = ray_towards(random, m.origin, 3);
      const RayHit a = instance.intersect(ray), b = copy.intersect(ray);
      if (a.found() != b.found() || a.primitive != b.primitive) {
        ++different;
        continue;
      }
      if (!a.found()) continue;
      ++hits;
      EXPECT_EQ(a.instance, 0u);
      EXPECT_EQ(b.instance, kNone);
      EXPECT_EQ(a.shape, 0u);
      const SurfaceHit p = instance.surface(ray, a), q = copy.surface(ray, b);
      EXPECT_LT(distance(p.position, q.position), 1e-4f);  // grazing rays slide along the surface
      EXPECT_LT(std::abs(dot(p.position - q.position, q.geometric_normal)), 5e-6f);
      EXPECT_LT(distance(p.geometric_normal, q.geometric_normal), 1e-5f);
      EXPECT_LT(distance(p.shading_normal, q.shading_normal),
                0.05f);  // the copy's vertex normals are normalised once more
      EXPECT_LT(p.error, 10 * q.error);
      const Parametrization s = instance.parametrization(a, p), t = copy.parametrization(b, q);
      EXPECT_NEAR(s.uv.x, t.uv.x, 1e-4f);
      EXPECT_NEAR(s.uv.y, t.uv.y, 1e-4f);
      EXPECT_LT(distance(s.dp_du, t.dp_du), 1e-4f);
      EXPECT_LT(distance(s.dp_dv, t.dp_dv), 1e-4f);
    }
    EXPECT_GT(hits, 50);
    EXPECT_LE(different, 3);
  }
}

TEST(Instance, KeepsShadingNormalsWhereAnglesAreKept) {
  Random random(2);
  const Transform m =
      Transform::translation({1, 2, 3}) * Transform::rotation(random.direction(), 1) * Transform::scaling({3, -3, 3});
  const Geometry instance = placed(bent_sheet(6), m), copy = built(transformed(bent_sheet(6), m));
  for (int i = 0; i < 500; ++i) {
    const Ray ray = ray_towards(random, m.origin, 3);
    const RayHit a = instance.intersect(ray), b = copy.intersect(ray);
    if (!a.found() || !b.found() || a.primitive != b.primitive) continue;
    EXPECT_LT(distance(instance.surface(ray, a).shading_normal, copy.surface(ray, b).shading_normal), 1e-5f);
  }
}

TEST(Instance, MakesEllipsoidsOfSpheres) {
  Random random(3);
  for (int repetition = 0; repetition < 20; ++repetition) {
    const Transform m = any_map(random, 1, random.direction() * 4, repetition % 2 == 1), back = m.inverse();
    const SphereShape sphere{{0.1f, -0.2f, 0.3f}, 0.7f};
    const Geometry geometry = placed(sphere, m);
    int hits = 0;
    for (int i = 0; i < 500; ++i) {
      const Ray ray = ray_towards(random, m.point(sphere.center), 1);
      const RayHit hit = geometry.intersect(ray);
      if (!hit.found()) continue;
      ++hits;
      const SurfaceHit surface = geometry.surface(ray, hit);
      const Vec3 local = back.point(surface.position) - sphere.center;
      EXPECT_NEAR(length(local), sphere.radius, 1e-5f);
      EXPECT_LT(distance(surface.position, ray.at(hit.t)), 1e-4f);
      // The gradient of |m⁻¹ p|.
      const Vec3 gradient(dot(local, back.x), dot(local, back.y), dot(local, back.z));
      EXPECT_LT(distance(surface.geometric_normal, normalize(gradient)), 1e-4f);
    }
    EXPECT_GT(hits, 100);
  }
}

TEST(Group, IsSeenOnlyThroughItsInstances) {
  Geometry geometry;
  EXPECT_EQ(geometry.add(SphereShape{{0, 0, 10}, 1}), 0u);
  const std::uint32_t group = geometry.begin_group();
  EXPECT_EQ(geometry.add(SphereShape{{0, 0, 0}, 1}), 1u);
  EXPECT_EQ(geometry.add(SphereShape{{5, 0, 0}, 1}), 2u);
  geometry.end_group();
  EXPECT_EQ(geometry.add(SphereShape{{0, 0, 20}, 1}), 3u);
  const std::uint32_t empty = geometry.begin_group();
  geometry.end_group();
  EXPECT_EQ(geometry.add_instance(group, Transform::translation({0, 50, 0})), 0u);
  EXPECT_EQ(geometry.add_instance(empty, Transform()), 1u);
  EXPECT_EQ(geometry.add_instance(group, Transform::translation({0, 60, 0})), 2u);
  geometry.build();
  const auto seen = [&](const Point3& at) {
    const RayHit hit = geometry.intersect({at + Vec3(0, 0, 3), {0, 0, -1}, 0, 4});
    return std::pair(hit.shape, hit.instance);
  };
  const auto hit = [](std::uint32_t shape, std::uint32_t instance) { return std::pair(shape, instance); };
  EXPECT_EQ(seen({0, 0, 0}), hit(kNone, kNone));
  EXPECT_EQ(seen({0, 0, 10}), hit(0, kNone));
  EXPECT_EQ(seen({0, 0, 20}), hit(3, kNone));
  EXPECT_EQ(seen({0, 50, 0}), hit(1, 0));
  EXPECT_EQ(seen({5, 50, 0}), hit(2, 0));
  EXPECT_EQ(seen({0, 60, 0}), hit(1, 2));
  EXPECT_EQ(seen({5, 60, 0}), hit(2, 2));
  EXPECT_EQ(geometry.bounds().min, Point3(-1, -1, -1));
  EXPECT_EQ(geometry.bounds().max, Point3(6, 61, 21));
  EXPECT_EQ(geometry.shape_count(), 4u);
  EXPECT_EQ(geometry.group_count(), 2u);
  EXPECT_EQ(geometry.instance_count(), 3u);
}

TEST(Group, CanBePlacedByInvertibleMapsOfSensibleSize) {
  EXPECT_TRUE(can_place(Transform()));
  EXPECT_TRUE(can_place(Transform::scaling({-1e-5f, 1e5f, 1})));
  EXPECT_FALSE(can_place(Transform::scaling({1, 0, 1})));
  EXPECT_FALSE(can_place(Transform::scaling({1, 1e-7f, 1})));
  EXPECT_FALSE(can_place(Transform::scaling({1, std::numeric_limits<float>::quiet_NaN(), 1})));
  EXPECT_FALSE(can_place(Transform::scaling({1, std::numeric_limits<float>::infinity(), 1})));
  EXPECT_FALSE(can_place(Transform::translation({std::numeric_limits<float>::infinity(), 0, 0})));
  // The smallest that is allowed, from as far as rays may come.
  const Transform smallest = Transform::scaling(Vec3(4.1e-6f));
  ASSERT_TRUE(can_place(smallest));
  const Geometry geometry = placed(SphereShape{{0, 0, 0}, 1e5f}, smallest);
  EXPECT_TRUE(geometry.intersect({{10, 0, 0}, {-1, 0, 0}}).found());
  EXPECT_FALSE(geometry.intersect({{1e12f, 0, 0}, {0, 1, 0}}).found());  // and Embree does not complain
}

/// Every kind of shape, in the world and in groups that are placed several times.
Geometry zoo() {
  Random random(4);
  Geometry geometry;
  const auto add_some = [&](float reach) {
    const auto somewhere = [&] { return random.direction() * (reach * random.value()); };
    geometry.add(transformed(bent_sheet(3), any_map(random, 0.2f, somewhere(), false)));
    geometry.add(SphereShape{somewhere(), 0.2f});
    geometry.add(DiskShape{any_map(random, 0.2f, somewhere(), true)});
    geometry.add(DiskShape{any_map(random, 0.3f, somewhere(), false)});
    geometry.add(CylinderShape{any_map(random, 0.15f, somewhere(), false)});
    geometry.add(CylinderShape{any_map(random, 0.2f, somewhere(), true)});
    geometry.add(random_curve(random, CurvesShape::Basis::linear, 0.5f, somewhere(), 0.1f));
    geometry.add(random_curve(random, CurvesShape::Basis::bspline, 0.5f, somewhere(), 0.1f));
  };
  add_some(1);
  for (int g = 0; g < 2; ++g) {
    const std::uint32_t group = geometry.begin_group();
    add_some(0.5f);
    geometry.end_group();
    for (int i = 0; i < 3; ++i) geometry.add_instance(group, any_map(random, 0.7f, random.direction(), i == 1));
  }
  geometry.build();
  return geometry;
}

TEST(AllShapes, PacketsAndOcclusionAgreeWithSingleRays) {
  const Geometry geometry = zoo();
  Random random(5);
  int different = 0, traced = 0, found = 0;
  std::array<int, 5> kinds{};
  for (int repetition = 0; repetition < 3000; ++repetition) {
    const int count = 1 + repetition % Geometry::kBatch;
    std::vector<Ray> rays;
    const Ray lead = ray_towards(random, {0, 0, 0}, 1.5f);
    for (int i = 0; i < count; ++i) {
      rays.push_back({lead.origin, normalize(lead.direction + random.direction() * 0.1f)});
      if (i % 3 == 1) rays.back().t_max = random.between(2, 8);
      if (i % 3 == 2) rays.back().t_min = random.between(2, 8);
    }
    std::vector<RayHit> hits(rays.size());
    geometry.intersect_coherent(rays, hits);
    const std::uint32_t blocked = geometry.occluded(rays);
    for (int i = 0; i < count; ++i, ++traced) {
      const RayHit single = geometry.intersect(rays[i]);
      const bool same =
          single.shape == hits[i].shape && single.instance == hits[i].instance &&
          (!single.found() || (single.primitive == hits[i].primitive && std::abs(single.t - hits[i].t) < 1e-4f));
      const bool alone = geometry.occluded(std::span(&rays[i], 1)) != 0;
      if (!same || single.found() != ((blocked >> i & 1u) != 0) || single.found() != alone) ++different;
      if (!single.found()) continue;
      ++found;
      ++kinds[static_cast<std::size_t>(geometry.kind(single.shape))];
    }
  }
  EXPECT_GT(found, traced / 5);
  EXPECT_GT(*std::ranges::min_element(kinds), 100) << "some kind is never seen";
  EXPECT_LE(different, traced / 2000);
}

/// Coordinates, tangents and normals of hits close to each other fit together: p′ − p = ∂p/∂u Δu + ∂p/∂v Δv.
TEST(AllShapes, TangentsAreThePositionsDerivatives) {
  const Geometry geometry = zoo();
  Random random(6);
  std::array<int, 5> kinds{}, wrong{};
  for (int i = 0; i < 60000; ++i) {
    const Ray ray = ray_towards(random, {0, 0, 0}, 1.5f);
    const Ray neighbour{ray.origin, normalize(ray.direction + random.direction() * 2e-4f)};
    const RayHit a = geometry.intersect(ray), b = geometry.intersect(neighbour);
    if (!a.found() || a.shape != b.shape || a.instance != b.instance || a.primitive != b.primitive) continue;
    const SurfaceHit p = geometry.surface(ray, a), q = geometry.surface(neighbour, b);
    if (std::abs(dot(p.geometric_normal, ray.direction)) < 0.3f ||
        distance(p.geometric_normal, q.geometric_normal) > 0.05f)
      continue;
    const Parametrization s = geometry.parametrization(a, p), t = geometry.parametrization(b, q);
    const float du = t.uv.x - s.uv.x, dv = t.uv.y - s.uv.y;
    const Geometry::Kind kind = geometry.kind(a.shape);
    if (std::max(std::abs(du), std::abs(dv)) > 0.4f) continue;    // across the seam
    if (kind == Geometry::Kind::disk && s.uv.x < 0.3f) continue;  // v changes too fast near the centre
    if (kind == Geometry::Kind::sphere && std::abs(s.uv.y - 0.5f) > 0.4f) continue;
    // Caps of linear curves: there v stands still.
    if (kind == Geometry::Kind::curves && (a.u < 0.01f || a.u > 0.99f)) continue;
    const Vec3 moved = q.position - p.position, predicted = s.dp_du * du + s.dp_dv * dv;
    ++kinds[static_cast<std::size_t>(kind)];
    if (distance(moved, predicted) > 0.05f * length(moved) + 1e-5f) ++wrong[static_cast<std::size_t>(kind)];
    EXPECT_EQ(t.uv, geometry.texture_coordinates(b, q));
    const Vec3 side = normalize(cross(s.dp_du, s.dp_dv));
    EXPECT_GT(std::abs(dot(side, p.geometric_normal)), 0.998f) << "kind " << static_cast<int>(kind);
  }
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    EXPECT_GT(kinds[kind], 300) << "kind " << kind;
    EXPECT_LE(wrong[kind], kinds[kind] / 100) << "kind " << kind;
  }
}

/// Where a ray meets a disk (height 0) or cylinder (height 1), from their equations, in doubles.
std::vector<double> reference(const Transform& m, bool cylinder, const Ray& ray) {
  const Vec3d x(m.x), y(m.y), z(m.z), r = Vec3d(ray.origin) - Vec3d(m.origin), w(ray.direction);
  const double det = x.dot(y.cross(z));
  const auto local = [&](const Vec3d& v) {
    return Vec3d(v.dot(y.cross(z)), v.dot(z.cross(x)), v.dot(x.cross(y))) / det;
  };
  const Vec3d o = local(r), d = local(w);
  std::vector<double> out;
  if (!cylinder) {
    const double t = -o.z / d.z;
    if (t > 0 && std::hypot(o.x + t * d.x, o.y + t * d.y) < 1) out.push_back(t);
    return out;
  }
  const double a = d.x * d.x + d.y * d.y, b = (o.x * d.x + o.y * d.y) / a, c = (o.x * o.x + o.y * o.y - 1) / a;
  for (const double sign : {-1.0, 1.0}) {
    const double t = -b + sign * std::sqrt(b * b - c);
    if (t > 0 && o.z + t * d.z > 0 && o.z + t * d.z < 1) out.push_back(t);
  }
  return out;
}

template <typename Shape>
void expect_reference(bool cylinder) {
  Random random(7);
  int wrong = 0, hits = 0, rays = 0;
  for (int repetition = 0; repetition < 40; ++repetition) {
    const bool flip = repetition % 4 >= 2;
    const Shape shape{any_map(random, 1, random.direction() * 2, repetition % 2 == 1), flip};
    const Geometry geometry = built(shape);
    const Transform& m = shape.to_world;
    for (int i = 0; i < 500; ++i, ++rays) {
      const Ray ray = ray_towards(random, m.origin, 2);
      const RayHit hit = geometry.intersect(ray);
      const std::vector<double> expected = reference(m, cylinder, ray);
      if (hit.found() == expected.empty() || (hit.found() && std::abs(hit.t - expected[0]) > 1e-5)) ++wrong;
      if (!hit.found()) continue;
      ++hits;
      const SurfaceHit surface = geometry.surface(ray, hit);
      EXPECT_LT(distance(surface.position, ray.at(hit.t)), 1e-5f);
      const ShapePoint point = point_at(shape, hit.u, hit.v);
      EXPECT_EQ(point.position, surface.position);
      EXPECT_EQ(point.normal, surface.geometric_normal);
      EXPECT_NEAR(length(point.normal), 1, 1e-5f);
      EXPECT_LT(
          std::abs(dot(point.normal, normalize(point.dp_da))) + std::abs(dot(point.normal, normalize(point.dp_db))),
          1e-5f);
      // Away from the axis, or the side that local +z is on.
      const Point3 behind = cylinder ? m.point({0, 0, hit.v}) : surface.position - m.z;
      EXPECT_EQ(dot(surface.geometric_normal, surface.position - behind) > 0, !flip);
    }
  }
  EXPECT_GT(hits, rays / 20);
  EXPECT_LE(wrong, rays / 2000);
}

TEST(Disk, IsWhereItsEquationSays) {
  expect_reference<DiskShape>(false);
}
TEST(Cylinder, IsWhereItsEquationSays) {
  expect_reference<CylinderShape>(true);
}

TEST(Sphere, FlippedHasItsFrontInside) {
  const SphereShape plain{{1, 2, 3}, 2, {0, 1, 0}, {1, 0, 0}};
  SphereShape flipped = plain;
  flipped.flip_normals = true;
  const Geometry a = built(plain), b = built(flipped);
  Random random(8);
  for (int i = 0; i < 100; ++i) {
    const Ray ray = ray_towards(random, plain.center, 1);
    const RayHit hit = b.intersect(ray);
    ASSERT_TRUE(hit.found());
    const SurfaceHit p = a.surface(ray, hit), q = b.surface(ray, hit);
    EXPECT_EQ(p.geometric_normal, -q.geometric_normal);
    EXPECT_EQ(p.shading_normal, -q.shading_normal);
    EXPECT_EQ(p.position, q.position);
    EXPECT_EQ(a.texture_coordinates(hit, p), b.texture_coordinates(hit, q));
    EXPECT_EQ(a.parametrization(hit, p).dp_dv, b.parametrization(hit, q).dp_dv);
  }
}

TEST(AnalyticShapes, HaveTheirTextureCoordinates) {
  const Geometry disk = built(DiskShape{});
  const auto uv = [](const Geometry& geometry, const Ray& ray) {
    const RayHit hit = geometry.intersect(ray);
    return geometry.texture_coordinates(hit, geometry.surface(ray, hit));
  };
  for (const float angle : {0.1f, 1.0f, 3.0f, 4.0f, 6.0f})
    for (const float radius : {0.2f, 0.9f}) {
      const Vec2 on_disk = uv(disk, {{radius * std::cos(angle), radius * std::sin(angle), 1}, {0, 0, -1}});
      EXPECT_NEAR(on_disk.x, radius, 1e-6f);
      EXPECT_NEAR(on_disk.y, angle / (2 * kPi), 1e-6f);
      const Vec3 out(std::cos(angle), std::sin(angle), 0);
      const Vec2 on_cylinder = uv(built(CylinderShape{}), {out * 2 + Vec3(0, 0, radius), -out});
      EXPECT_NEAR(on_cylinder.x, angle / (2 * kPi), 1e-6f);
      EXPECT_NEAR(on_cylinder.y, radius, 1e-6f);
    }
  const Ray center{{0, 0, 1}, {0, 0, -1}};
  const RayHit hit = disk.intersect(center);
  const Parametrization at_center = disk.parametrization(hit, disk.surface(center, hit));
  EXPECT_TRUE(is_finite(at_center.dp_du) && is_finite(at_center.dp_dv));
}

/// Sum over small triangles between points of the shape.
template <typename Shape>
double tessellated_area(const Shape& shape, auto parameters) {
  constexpr int kCells = 400;
  const auto at = [&](int i, int j) {
    const Vec2 p = parameters(static_cast<float>(i) / kCells, static_cast<float>(j) / kCells);
    return point_at(shape, p.x, p.y).position;
  };
  double sum = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const Point3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      sum +=
          0.5 * (static_cast<double>(length(cross(b - a, c - a))) + static_cast<double>(length(cross(c - a, d - a))));
    }
  return sum;
}

TEST(AnalyticShapes, KnowAreasAndBounds) {
  Random random(9);
  for (int repetition = 0; repetition < 5; ++repetition) {
    const DiskShape disk{any_map(random, 3, random.direction(), repetition % 2 == 0)};
    const CylinderShape cylinder{any_map(random, 3, random.direction(), repetition % 2 == 0)};
    const double disk_area = tessellated_area(
        disk, [](float r, float turns) { return Vec2(r * std::cos(2 * kPi * turns), r * std::sin(2 * kPi * turns)); });
    const double cylinder_area = tessellated_area(cylinder, [](float turns, float z) { return Vec2(turns, z); });
    EXPECT_NEAR(area_of(disk) / disk_area, 1, 1e-3);
    EXPECT_NEAR(area_of(cylinder) / cylinder_area, 1, 1e-3);
    Bounds3 seen;
    for (int i = 0; i < 20000; ++i)
      seen.extend(point_at(cylinder, random.value(), random.value() < 0.5f ? 0.0f : 1.0f).position);
    EXPECT_LT(distance(seen.min, bounds_of(cylinder).min), 1e-3f);
    EXPECT_LT(distance(seen.max, bounds_of(cylinder).max), 1e-3f);
  }
}

TEST(Cylinder, OfUnitSizeHasItsArea) {
  EXPECT_NEAR(area_of(CylinderShape{Transform::scaling({2, 2, 3})}), 12 * kPi, 1e-4f);
}

/// A direction on the side of `normal`; a third of them graze the surface.
Vec3 leaving(Random& random, const Vec3& normal, int i) {
  if (i % 3 == 0)
    return normalize(normalize(cross(normal, random.direction())) + normal * std::pow(10.0f, random.between(-5, -1)));
  const Vec3 w = random.direction();
  return dot(w, normal) < 0 ? -w : w;
}

/// Size, and distance from the origin in units of it.
struct Place {
  float scale, remoteness;
};
const Place kPlaces[] = {{1e-4f, 0}, {1e-4f, 10}, {1e-4f, 1000}, {1, 0},    {1, 10},
                         {1, 1000},  {1, 1e5f},   {1e6f, 0},     {1e6f, 10}};

/// Rays that leave convex shapes outward must not meet them again.
template <typename Make>
void expect_no_self_hits(const char* what, float tolerated, Make make) {
  Random random(10);
  for (const Place& place : kPlaces) {
    int hits = 0, self_hits = 0;
    float largest_error = 0;
    for (int repetition = 0; repetition < 20; ++repetition) {
      const Point3 center = random.direction() * (place.scale * place.remoteness);
      const Geometry geometry = make(random, place.scale, center, repetition % 2 == 1);
      for (int i = 0; i < 500; ++i) {
        const Ray arriving = ray_towards(random, center, place.scale);
        const RayHit hit = geometry.intersect(arriving);
        if (!hit.found()) continue;
        const SurfaceHit surface = geometry.surface(arriving, hit);
        if (dot(surface.geometric_normal, arriving.direction) > 0) continue;  // the inside sees itself
        ++hits;
        const Vec3 w = leaving(random, surface.geometric_normal, i);
        if (geometry.intersect({offset_origin(surface, w), w}).found()) ++self_hits;
        largest_error = std::max(largest_error, surface.error);
      }
    }
    EXPECT_GT(hits, 300) << what;
    EXPECT_LE(static_cast<float>(self_hits), tolerated * static_cast<float>(hits))
        << what << ", scale " << place.scale << ", " << place.remoteness << " times as far from the origin";
    EXPECT_LE(largest_error, 2e-4f * place.scale * (1 + place.remoteness)) << what << ": further off than need be";
  }
}

TEST(OffsetOrigin, RaysLeaveEveryShapeForGood) {
  expect_no_self_hits("disk", 0, [](Random& random, float scale, const Point3& center, bool mirrored) {
    return built(DiskShape{any_map(random, scale, center, mirrored)});
  });
  expect_no_self_hits("cylinder", 0, [](Random& random, float scale, const Point3& center, bool mirrored) {
    return built(CylinderShape{any_map(random, scale, center, mirrored)});
  });
  expect_no_self_hits("linear curve", 0, [](Random& random, float scale, const Point3& center, bool) {
    const Vec3 half = random.direction() * (0.5f * scale);
    return built(
        CurvesShape{CurvesShape::Basis::linear, {{center - half, 0.1f * scale}, {center + half, 0.2f * scale}}, {0}});
  });
  expect_no_self_hits("straight B-spline", 1e-3f, [](Random& random, float scale, const Point3& center, bool) {
    const Vec3 step = random.direction() * scale;
    return built(CurvesShape{CurvesShape::Basis::bspline,
                             {{center - step * 1.5f, 0.2f * scale},
                              {center - step * 0.5f, 0.2f * scale},
                              {center + step * 0.5f, 0.2f * scale},
                              {center + step * 1.5f, 0.2f * scale}},
                             {0}});
  });
}

TEST(OffsetOrigin, RaysLeaveInstancesForGood) {
  expect_no_self_hits("triangle", 0, [](Random& random, float scale, const Point3& center, bool mirrored) {
    return placed(TriangleMesh{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, {}, {}, {{0, 1, 2}}},
                  any_map(random, scale, center, mirrored));
  });
  expect_no_self_hits("ellipsoid", 0, [](Random& random, float scale, const Point3& center, bool mirrored) {
    return placed(SphereShape{{0, 0, 0}, 0.7f}, any_map(random, scale, center, mirrored));
  });
  expect_no_self_hits("disk", 0, [](Random& random, float scale, const Point3& center, bool mirrored) {
    return placed(DiskShape{}, any_map(random, scale, center, mirrored));
  });
  expect_no_self_hits("ellipsoid far from its group's origin", 0,
                      [](Random& random, float scale, const Point3& center, bool mirrored) {
                        const Transform m = any_map(random, scale, {0, 0, 0}, mirrored);
                        const Point3 away = random.direction() * 10.0f;
                        return placed(SphereShape{away, 0.7f}, Transform::translation(center - m.point(away)) * m);
                      });
}

/// Signed distance to spheres of the curve's radius all along it.
double tube_distance(const CurvesShape& curves, const Vec3d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint32_t segment = 0; segment < curves.segments.size(); ++segment)
    for (int i = 0; i <= 400; ++i) {
      const CurvePlace place = place_on(curves, segment, static_cast<float>(i) / 400);
      nearest = std::min(nearest, (p - Vec3d(place.center)).length() - place.radius);
    }
  return nearest;
}

TEST(Curves, AreTubesWithOutwardNormals) {
  for (const CurvesShape::Basis basis : {CurvesShape::Basis::linear, CurvesShape::Basis::bspline}) {
    const bool linear = basis == CurvesShape::Basis::linear;
    Random random(11);
    int hits = 0;
    for (int repetition = 0; repetition < 10; ++repetition) {
      CurvesShape curves = random_curve(random, basis, 1, {0, 0, 0}, 0.1f);
      if (!linear)
        for (CurvePoint& p : curves.points) p.radius = 0.1f;
      const Geometry geometry = built(curves);
      for (int i = 0; i < 200; ++i) {
        const Ray ray = ray_towards(random, curves.points[2].position, 1);
        const RayHit hit = geometry.intersect(ray);
        if (!hit.found()) continue;
        const SurfaceHit surface = geometry.surface(ray, hit);
        EXPECT_LT(distance(surface.position, ray.at(hit.t)), 1e-4f);
        EXPECT_LT(dot(surface.geometric_normal, ray.direction), 1e-3f);
        if (!linear && (hit.u < 0.02f || hit.u > 0.98f)) continue;  // the ends of B-splines are open
        ++hits;
        const Vec3d p(surface.position);
        const double here = tube_distance(curves, p);
        EXPECT_NEAR(here, 0, 1e-4);
        EXPECT_GT(tube_distance(curves, p + Vec3d(surface.geometric_normal) * 0.01), here + 0.0098);
      }
    }
    EXPECT_GT(hits, 300);
  }
}

TEST(Curves, MissNothingThatIsOnTheWay) {
  Random random(12);
  int wrong = 0, found = 0;
  constexpr int kRays = 600;
  const CurvesShape curves = random_curve(random, CurvesShape::Basis::linear, 1, {0, 0, 0}, 0.3f);
  const Geometry geometry = built(curves);
  for (int i = 0; i < kRays; ++i) {
    const Ray ray = ray_towards(random, curves.points[1].position, 1);
    double t = 0, step = 1;
    for (int k = 0; k < 200 && t < 20 && step > 1e-6; ++k)
      t += step = tube_distance(curves, Vec3d(ray.origin) + Vec3d(ray.direction) * t);
    const RayHit hit = geometry.intersect(ray);
    found += hit.found();
    if (hit.found() != (t < 20) || (hit.found() && std::abs(hit.t - t) > 1e-3)) ++wrong;
  }
  EXPECT_GT(found, kRays / 5);
  EXPECT_LE(wrong, kRays / 100);
}

TEST(Curves, AreNotSeenFromInside) {
  for (const CurvesShape::Basis basis : {CurvesShape::Basis::linear, CurvesShape::Basis::bspline}) {
    const CurvesShape curves{basis,
                             {{{0, 0, 0}, 0.1f}, {{1, 0, 0}, 0.1f}, {{2, 0, 0}, 0.1f}, {{3, 0, 0}, 0.1f}},
                             {basis == CurvesShape::Basis::linear ? 1u : 0u}};
    const Geometry geometry = built(curves);
    Random random(13);
    for (int i = 0; i < 200; ++i) {
      const Ray ray{{1.5f, 0, 0}, normalize(Vec3(random.between(-0.5f, 0.5f), 1, random.between(-1, 1)))};
      EXPECT_FALSE(geometry.intersect(ray).found());
      EXPECT_EQ(geometry.occluded(std::span(&ray, 1)), 0u);
    }
    EXPECT_TRUE(geometry.intersect({{1.5f, 1, 0}, {0, -1, 0}}).found());
  }
}

TEST(Curves, RunAlongV) {
  CurvesShape curves{CurvesShape::Basis::linear, {{{0, 0, 0}, 0.1f}, {{0, 0, 1}, 0.1f}, {{0, 0, 3}, 0.1f}}, {0, 1}};
  const Geometry geometry = built(curves);
  const auto v = [&](float z) {
    const Ray ray{{1, 0, z}, {-1, 0, 0}};
    const RayHit hit = geometry.intersect(ray);
    return geometry.texture_coordinates(hit, geometry.surface(ray, hit)).y;
  };
  EXPECT_NEAR(v(0.5f), 0.25f, 1e-5f);
  EXPECT_NEAR(v(1.5f), 0.625f, 1e-5f);
  EXPECT_NEAR(v(2.5f), 0.875f, 1e-5f);
}

TEST(Attributes, AreInterpolatedOrOfTheFace) {
  Geometry geometry;
  const std::uint32_t unused = geometry.attribute_id("vertex_unused");
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {}, {}, {{0, 1, 2}, {3, 2, 1}}};
  mesh.attributes = {{"vertex_color", false, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1, 5, 5, 5}},
                     {"face_weight", true, 1, {3, 4}}};
  const std::uint32_t shape = geometry.add(mesh);
  const std::uint32_t sphere = geometry.add(SphereShape{{5, 0, 0}, 1});
  std::swap(mesh.attributes[0], mesh.attributes[1]);
  for (Point3& p : mesh.positions) p.z = 1;
  geometry.add(mesh);
  geometry.build();
  const std::uint32_t color = geometry.attribute_id("vertex_color"), weight = geometry.attribute_id("face_weight");
  EXPECT_TRUE(geometry.has_attribute(shape, color));
  EXPECT_FALSE(geometry.has_attribute(shape, unused));
  EXPECT_FALSE(geometry.has_attribute(sphere, color));
  for (const float from : {-1.0f, 2.0f}) {
    const RayHit hit = geometry.intersect({{0.2f, 0.3f, from}, {0, 0, from < 0 ? 1.0f : -1.0f}});
    const Spectrum value = geometry.attribute(hit, color).value();
    EXPECT_NEAR(value.r, 0.5f, 1e-6f);
    EXPECT_NEAR(value.g, 0.2f, 1e-6f);
    EXPECT_NEAR(value.b, 0.3f, 1e-6f);
    EXPECT_EQ(geometry.attribute(hit, weight), Spectrum(3));
    EXPECT_EQ(geometry.attribute(geometry.intersect({{0.9f, 0.8f, from}, {0, 0, from < 0 ? 1.0f : -1.0f}}), weight),
              Spectrum(4));
    EXPECT_FALSE(geometry.attribute(hit, unused));
  }
  EXPECT_FALSE(geometry.attribute(geometry.intersect({{5, 0, 5}, {0, 0, -1}}), color));
}

TEST(Parametrization, OfMirroredSpheresRunsTheOtherWay) {
  const Vec3 pole = normalize(Vec3(1, 2, -1)), meridian = normalize(cross(pole, Vec3(0, 0, 1)));
  const SphereShape plain{{0, 0, 0}, 1, pole, meridian}, mirrored{{0, 0, 0}, 1, pole, meridian, false, true};
  const Geometry a = built(plain), b = built(mirrored);
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Vec3 outward = random.direction();
    const Ray inwards{outward * 3, -outward};
    const RayHit hit = a.intersect(inwards);
    const Parametrization p = a.parametrization(hit, a.surface(inwards, hit)),
                          q = b.parametrization(hit, b.surface(inwards, hit));
    EXPECT_NEAR(p.uv.x + q.uv.x, 1, 1e-5f);
    EXPECT_NEAR(p.uv.y, q.uv.y, 1e-6f);
    EXPECT_LT(distance(p.dp_du, -q.dp_du) + distance(p.dp_dv, q.dp_dv), 1e-4f);
  }
}

TEST(Parametrization, HasTangentsWhereCoordinatesSayNothing) {
  for (const bool missing : {true, false}) {
    TriangleMesh mesh = bent_sheet(2);
    for (Vec2& uv : mesh.uvs) uv = {0.5f, 0.5f};
    if (missing) mesh.uvs.clear();
    const Geometry geometry = built(mesh);
    const Ray ray{{0.1f, 0.2f, 3}, {0, 0, -1}};
    const RayHit hit = geometry.intersect(ray);
    const Parametrization parametrization = geometry.parametrization(hit, geometry.surface(ray, hit));
    EXPECT_GT(length(cross(parametrization.dp_du, parametrization.dp_dv)), 0.01f);
  }
}

}  // namespace
}  // namespace etendue
