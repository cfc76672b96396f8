#include "geometry/geometry.h"

#include <gtest/gtest.h>

#include <optional>

#include "testing/expect_near.h"
#include "testing/random.h"

namespace etendue {
namespace {

TriangleMesh one_triangle() {
  return {{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}},
          {normalize(Vec3(-1, 0, 1)), normalize(Vec3(1, 0, 1)), {0, 0, 1}},
          {{0.5f, 0.25f}, {1.5f, 0.25f}, {0.5f, 2.25f}},
          {{0, 1, 2}}};
}

/// `cells`² × 2 triangles over a square of the given size, turned any way.
TriangleMesh tilted_square(Random& random, const Point3& center, float size, int cells) {
  const Vec3 normal = random.direction();
  const Vec3 x = normalize(cross(normal, random.direction())), y = cross(normal, x);
  TriangleMesh mesh;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const float a = static_cast<float>(i) / static_cast<float>(cells) - 0.5f;
      const float b = static_cast<float>(j) / static_cast<float>(cells) - 0.5f;
      mesh.positions.push_back(center + (x * a + y * b) * size);
    }
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(j * (cells + 1) + i); };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return mesh;
}

Geometry built(TriangleMesh mesh) {
  Geometry geometry;
  geometry.add(std::move(mesh));
  geometry.build();
  return geometry;
}

Geometry built(const SphereShape& sphere) {
  Geometry geometry;
  geometry.add(sphere);
  geometry.build();
  return geometry;
}

/// Triangles and spheres of many sizes between −1 and 1, in eight meshes and twenty spheres.
Geometry clutter() {
  Random random(99);
  Geometry geometry;
  for (int m = 0; m < 8; ++m) {
    TriangleMesh mesh;
    for (std::uint32_t t = 0; t < 50; ++t) {
      const Point3 center(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
      const float size = random.between(0.02f, 0.4f);
      for (int v = 0; v < 3; ++v) mesh.positions.push_back(center + random.direction() * size);
      mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    geometry.add(std::move(mesh));
  }
  for (int s = 0; s < 20; ++s)
    geometry.add(SphereShape{{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)},
                             random.between(0.01f, 0.3f)});
  geometry.build();
  return geometry;
}

Ray random_ray(Random& random) {
  const Point3 origin(random.between(-2, 2), random.between(-2, 2), random.between(-2, 2));
  const Point3 target(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  return {origin, normalize(target - origin)};
}

TEST(Triangle, IsHitFromBothSides) {
  const Geometry geometry = built(one_triangle());
  for (const float side : {1.0f, -1.0f}) {
    const Ray ray{{0.5f, 0.25f, 3 * side}, {0, 0, -side}};
    const RayHit hit = geometry.intersect(ray);
    ASSERT_TRUE(hit.found());
    EXPECT_EQ(hit.shape, 0u);
    EXPECT_EQ(hit.primitive, 0u);
    EXPECT_NEAR(hit.t, 3, 1e-6);
    EXPECT_NEAR(hit.u, 0.25f, 1e-6);
    EXPECT_NEAR(hit.v, 0.25f, 1e-6);
    const SurfaceHit surface = geometry.surface(ray, hit);
    expect_near(surface.position, {0.5f, 0.25f, 0}, 1e-6f);
    expect_near(surface.geometric_normal, {0, 0, 1}, 1e-6f);  // the front, wherever the ray came from
  }
}

TEST(Triangle, IsMissedBesideAndBeyond) {
  const Geometry geometry = built(one_triangle());
  EXPECT_FALSE(geometry.intersect({{1.1f, 0.5f, 1}, {0, 0, -1}}).found());
  EXPECT_FALSE(geometry.intersect({{0.5f, 0.25f, 1}, {0, 0, 1}}).found());
  EXPECT_FALSE(geometry.intersect({{0.5f, 0.25f, 1}, {0, 0, -1}, 0, 0.9f}).found());
  EXPECT_FALSE(geometry.intersect({{0.5f, 0.25f, 1}, {0, 0, -1}, 1.1f}).found());
  EXPECT_TRUE(geometry.intersect({{0.5f, 0.25f, 1}, {0, 0, -1}, 0.9f, 1.1f}).found());
}

TEST(Triangle, InterpolatesNormalsAndTextureCoordinates) {
  const Geometry geometry = built(one_triangle());
  const Ray ray{{0.4f, 0.5f, 1}, {0, 0, -1}};  // weights 0.3, 0.2, 0.5
  const RayHit hit = geometry.intersect(ray);
  const SurfaceHit surface = geometry.surface(ray, hit);
  const float h = std::sqrt(0.5f);
  const Vec3 expected = normalize(Vec3(-h, 0, h) * 0.3f + Vec3(h, 0, h) * 0.2f + Vec3(0, 0, 1) * 0.5f);
  expect_near(surface.shading_normal, expected, 1e-6f);
  const Vec2 uv = geometry.texture_coordinates(hit, surface);
  EXPECT_NEAR(uv.x, 0.5f + 0.2f, 1e-6);
  EXPECT_NEAR(uv.y, 0.25f + 0.5f * 2, 1e-6);
}

TEST(Triangle, WithoutNormalsAndCoordinatesIsFlat) {
  TriangleMesh mesh = one_triangle();
  mesh.normals.clear();
  mesh.uvs.clear();
  const Geometry geometry = built(mesh);
  const Ray ray{{0.5f, 0.25f, 1}, {0, 0, -1}};
  const RayHit hit = geometry.intersect(ray);
  const SurfaceHit surface = geometry.surface(ray, hit);
  EXPECT_EQ(surface.shading_normal, surface.geometric_normal);
  EXPECT_EQ(geometry.texture_coordinates(hit, surface), Vec2(hit.u, hit.v));
}

TEST(Triangle, ShadingNormalStaysOnTheFront) {
  TriangleMesh mesh = one_triangle();
  for (Vec3& n : mesh.normals) n = -n;
  const Geometry geometry = built(mesh);
  for (const float side : {1.0f, -1.0f}) {
    const Ray ray{{0.5f, 0.25f, side}, {0, 0, -side}};
    const SurfaceHit surface = geometry.surface(ray, geometry.intersect(ray));
    EXPECT_GT(dot(surface.shading_normal, surface.geometric_normal), 0);
    EXPECT_NEAR(length(surface.shading_normal), 1, 1e-6);
  }
}

TEST(Triangle, NormalsThatCancelGiveTheFlatOne) {
  TriangleMesh mesh = one_triangle();
  mesh.normals = {{1, 0, 0}, {-1, 0, 0}, {1, 0, 0}};
  const Geometry geometry = built(mesh);
  const Ray ray{{1, 0, 1}, {0, 0, -1}};  // the middle of the edge between the first two
  const RayHit hit = geometry.intersect(ray);
  ASSERT_TRUE(hit.found());
  const SurfaceHit surface = geometry.surface(ray, hit);
  EXPECT_TRUE(is_finite(surface.shading_normal));
  EXPECT_NEAR(length(surface.shading_normal), 1, 1e-6);
}

TEST(Sphere, IsHitFromOutsideAndInside) {
  const Geometry geometry = built(SphereShape{{1, 2, 3}, 0.5f});
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 d = random.direction();
    const Ray outside{Point3(1, 2, 3) - d * 2, d}, inside{{1, 2, 3}, d};
    const RayHit near = geometry.intersect(outside), back = geometry.intersect(inside);
    ASSERT_TRUE(near.found() && back.found());
    EXPECT_NEAR(near.t, 1.5f, 1e-5);
    EXPECT_NEAR(back.t, 0.5f, 1e-5);
    expect_near(geometry.surface(outside, near).geometric_normal, -d, 1e-5f);
    expect_near(geometry.surface(inside, back).geometric_normal, d, 1e-5f);  // the front is the outside
    expect_near(geometry.surface(inside, back).position, Point3(1, 2, 3) + d * 0.5f, 1e-5f);
  }
}

TEST(Sphere, HasLongitudeAndLatitude) {
  const Geometry geometry = built(SphereShape{{0, 0, 0}, 1});
  const auto uv = [&](const Vec3& n) {
    const Ray ray{n * 3, -n};
    const RayHit hit = geometry.intersect(ray);
    return geometry.texture_coordinates(hit, geometry.surface(ray, hit));
  };
  EXPECT_NEAR(uv({0, 1, 0}).y, 1, 1e-3);
  EXPECT_NEAR(uv({0, -1, 0}).y, 0, 1e-3);
  EXPECT_NEAR(uv(normalize(Vec3(1, 1, 0))).y, 0.75f, 1e-5);
  // A quarter turn counter-clockwise about the pole is a quarter of the width, to the east.
  const auto turn = [&](float angle) { return uv({std::cos(angle), 0, -std::sin(angle)}).x; };
  for (const float angle : {-2.0f, -0.5f, 0.3f, 1.0f}) {
    EXPECT_NEAR(turn(angle), 0.5f + angle / (2 * kPi), 1e-5);
    EXPECT_NEAR(uv({std::cos(angle), 0, -std::sin(angle)}).y, 0.5f, 1e-5);
  }
}

TEST(Sphere, AxisMovesThePole) {
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 0, 1), normalize(Vec3(-1, 2, 3))}) {
    const Geometry geometry = built(SphereShape{{0, 0, 0}, 2, axis});
    const Ray ray{axis * 5, -axis};
    const RayHit hit = geometry.intersect(ray);
    EXPECT_NEAR(geometry.texture_coordinates(hit, geometry.surface(ray, hit)).y, 1, 1e-3);
  }
}

TEST(Sphere, MeridianTurnsTheTexture) {
  const auto u = [](const Vec3& meridian) {
    const Geometry geometry = built(SphereShape{{0, 0, 0}, 2, {0, 1, 0}, meridian});
    const Ray ray{{5, 0, 0}, {-1, 0, 0}};
    const RayHit hit = geometry.intersect(ray);
    return geometry.texture_coordinates(hit, geometry.surface(ray, hit)).x;
  };
  EXPECT_NEAR(u({1, 0, 0}), 0.5f, 1e-5);
  EXPECT_NEAR(u({0, 0, -1}), 0.25f, 1e-5);
}

/// Nearest intersection with a shape, in doubles.
std::optional<double> reference_distance(const Geometry& geometry, const Ray& ray) {
  const Vec3d o(ray.origin), d(ray.direction);
  std::optional<double> nearest;
  const auto offer = [&](double t) {
    if (t > 0 && (!nearest || t < *nearest)) nearest = t;
  };
  for (std::uint32_t id = 0; id < geometry.shape_count(); ++id) {
    if (geometry.is_sphere(id)) {
      const SphereShape& s = geometry.sphere(id);
      const Vec3d c = o - Vec3d(s.center);
      const double b = c.dot(d), q = b * b - c.dot(c) + static_cast<double>(s.radius) * s.radius;
      if (q < 0) continue;
      offer(-b - std::sqrt(q));
      offer(-b + std::sqrt(q));
      continue;
    }
    const TriangleMesh& m = geometry.mesh(id);
    for (const auto& [i, j, k] : m.triangles) {
      const Vec3d p(m.positions[i]), e1 = Vec3d(m.positions[j]) - p, e2 = Vec3d(m.positions[k]) - p;
      const Vec3d h = d.cross(e2), s = o - p, q = s.cross(e1);
      const double a = e1.dot(h), u = s.dot(h) / a, v = d.dot(q) / a;
      if (u >= 0 && v >= 0 && u + v <= 1) offer(e2.dot(q) / a);
    }
  }
  return nearest;
}

TEST(Geometry, AgreesWithBruteForce) {
  const Geometry geometry = clutter();
  Random random(2);
  int different = 0, found = 0;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    const Ray ray = random_ray(random);
    const RayHit hit = geometry.intersect(ray);
    const std::optional<double> reference = reference_distance(geometry, ray);
    found += hit.found();
    if (hit.found() != reference.has_value() || (reference && std::abs(*reference - hit.t) > 1e-4)) ++different;
    if (!hit.found()) continue;
    const SurfaceHit surface = geometry.surface(ray, hit);
    EXPECT_LT(length(surface.position - ray.at(hit.t)), 1e-5f);
    EXPECT_NEAR(length(surface.geometric_normal), 1, 1e-6);
  }
  EXPECT_GT(found, kRays / 2);
  EXPECT_LE(different, kRays / 5000);  // rays that graze an edge may go either way
}

TEST(Geometry, PacketsFindWhatSingleRaysFind) {
  const Geometry geometry = clutter();
  Random random(3);
  int different = 0, rays_traced = 0;
  for (int repetition = 0; repetition < 2000; ++repetition) {
    const int count = 1 + repetition % Geometry::kBatch;
    std::vector<Ray> rays;
    const Ray lead = random_ray(random);
    for (int i = 0; i < count; ++i) {
      rays.push_back({lead.origin, normalize(lead.direction + random.direction() * 0.1f)});
      if (i % 3 == 1) rays.back().t_max = random.between(0.5f, 3.0f);
      if (i % 3 == 2) rays.back().t_min = random.between(0.0f, 2.0f);
    }
    std::vector<RayHit> hits(rays.size());
    geometry.intersect_coherent(rays, hits);
    for (int i = 0; i < count; ++i, ++rays_traced) {
      const RayHit single = geometry.intersect(rays[i]);
      const bool same =
          single.found() == hits[i].found() &&
          (!single.found() || (single.shape == hits[i].shape && single.primitive == hits[i].primitive &&
                               std::abs(single.t - hits[i].t) < 1e-5f && std::abs(single.u - hits[i].u) < 1e-3f &&
                               std::abs(single.v - hits[i].v) < 1e-3f));
      if (!same) ++different;
    }
  }
  EXPECT_LE(different, rays_traced / 5000);
}

TEST(Geometry, OcclusionIsThatSomethingIsHit) {
  const Geometry geometry = clutter();
  Random random(4);
  int different = 0, rays_traced = 0, blocked = 0;
  for (int repetition = 0; repetition < 2000; ++repetition) {
    const int count = 1 + repetition % Geometry::kBatch;
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {
      rays.push_back(random_ray(random));
      rays.back().t_max = random.between(0.1f, 3.0f);
    }
    const std::uint32_t mask = geometry.occluded(rays);
    EXPECT_EQ(mask >> count, 0u) << "bits beyond the rays";
    for (int i = 0; i < count; ++i, ++rays_traced) {
      const bool hit = geometry.intersect(rays[i]).found();
      blocked += hit;
      if ((mask >> i & 1u) != (hit ? 1u : 0u)) ++different;
    }
  }
  EXPECT_GT(blocked, rays_traced / 5);
  EXPECT_LT(blocked, rays_traced * 4 / 5);
  EXPECT_LE(different, rays_traced / 5000);
}

TEST(Geometry, KnowsItsSizeAndBounds) {
  Geometry geometry;
  EXPECT_TRUE(geometry.bounds().empty());
  EXPECT_EQ(geometry.add(one_triangle()), 0u);
  EXPECT_EQ(geometry.add(SphereShape{{5, 0, 0}, 2}), 1u);
  geometry.build();
  EXPECT_EQ(geometry.shape_count(), 2u);
  EXPECT_EQ(geometry.triangle_count(), 1u);
  EXPECT_EQ(geometry.sphere_count(), 1u);
  EXPECT_FALSE(geometry.is_sphere(0));
  EXPECT_TRUE(geometry.is_sphere(1));
  EXPECT_EQ(geometry.bounds().min, Point3(0, -2, -2));
  EXPECT_EQ(geometry.bounds().max, Point3(7, 2, 2));
  const Geometry moved = std::move(geometry);
  EXPECT_TRUE(moved.intersect({{5, 0, 9}, {0, 0, -1}}).found());
}

TEST(Geometry, WithoutShapesIsEmpty) {
  Geometry geometry;
  geometry.build();
  const Ray ray{{0, 0, 0}, {0, 0, 1}};
  EXPECT_FALSE(geometry.intersect(ray).found());
  EXPECT_EQ(geometry.occluded(std::span(&ray, 1)), 0u);
}

/// A direction that leaves the surface on the side of `normal`; a third of them graze it.
Vec3 leaving(Random& random, const Vec3& normal, int i) {
  if (i % 3 == 0) {
    const Vec3 tangent = normalize(cross(normal, random.direction()));
    return normalize(tangent + normal * std::pow(10.0f, random.between(-5, -1)));
  }
  const Vec3 w = random.direction();
  return dot(w, normal) < 0 ? -w : w;
}

/// Where shapes stand: size, and distance from the origin in units of it.
struct Place {
  float scale, remoteness;
};
const Place kPlaces[] = {{1e-3f, 0}, {1e-3f, 10}, {1e-3f, 1000}, {1, 0},      {1, 10},
                         {1, 1000},  {1e4f, 0},   {1e4f, 10},    {1e4f, 1000}};

TEST(OffsetOrigin, RaysLeaveAPlaneForGood) {
  Random random(5);
  for (const Place& place : kPlaces)
    for (int repetition = 0; repetition < 40; ++repetition) {
      const Point3 center = random.direction() * (place.scale * place.remoteness);
      const Geometry geometry = built(tilted_square(random, center, place.scale, repetition % 2 == 0 ? 1 : 4));
      const TriangleMesh& mesh = geometry.mesh(0);
      const Point3& corner = mesh.positions[0];
      const Vec3 normal = normalize(cross(mesh.positions[1] - corner, mesh.positions.back() - corner));
      int hits = 0, self_hits = 0;
      for (int i = 0; i < 1000; ++i) {
        // Also very near the centre, which is the origin itself for the first of the places.
        const Point3 target =
            center + random.direction() * (place.scale * 0.4f * std::pow(10.0f, random.between(-5, 0)));
        const Point3 origin = target + leaving(random, normal, 1) * (place.scale * random.between(0.1f, 30));
        const Ray arriving{origin, normalize(target - origin)};
        const RayHit hit = geometry.intersect(arriving);
        if (!hit.found()) continue;
        ++hits;
        const SurfaceHit surface = geometry.surface(arriving, hit);
        const Vec3 side = i % 2 == 0 ? surface.geometric_normal : -surface.geometric_normal;
        const Vec3 w = leaving(random, side, i);
        if (geometry.intersect({offset_origin(surface, w), w}).found()) ++self_hits;
        EXPECT_LE(surface.error, 1e-5f * place.scale * (1 + place.remoteness)) << "further off than need be";
      }
      EXPECT_GT(hits, 100);
      EXPECT_EQ(self_hits, 0) << "scale " << place.scale << ", " << place.remoteness << " times as far from the origin";
    }
}

TEST(OffsetOrigin, RaysLeaveASphereForGood) {
  Random random(6);
  for (const Place& place : kPlaces) {
    const Point3 center = random.direction() * (place.scale * place.remoteness);
    const Geometry geometry = built(SphereShape{center, place.scale});
    int hits = 0, self_hits = 0;
    for (int i = 0; i < 20000; ++i) {
      const Point3 target = center + random.direction() * (place.scale * random.value());
      const Point3 origin = center + random.direction() * (place.scale * random.between(1.1f, 30));
      const Ray arriving{origin, normalize(target - origin)};
      const RayHit hit = geometry.intersect(arriving);
      if (!hit.found()) continue;
      ++hits;
      const SurfaceHit surface = geometry.surface(arriving, hit);
      const Vec3 w = leaving(random, surface.geometric_normal, i);
      if (geometry.intersect({offset_origin(surface, w), w}).found()) ++self_hits;
    }
    EXPECT_GT(hits, 10000);
    EXPECT_EQ(self_hits, 0) << "radius " << place.scale << ", " << place.remoteness << " times as far from the origin";
  }
}

TEST(OffsetOrigin, RaysIntoASphereMeetItsFarSide) {
  Random random(7);
  for (const Place& place : kPlaces) {
    const Point3 center = random.direction() * (place.scale * place.remoteness);
    const Geometry geometry = built(SphereShape{center, place.scale});
    const float tolerance = place.remoteness > 100 ? 0.05f : 0.01f;
    int wrong = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 d = random.direction();
      const Ray arriving{center - d * (3 * place.scale), d};
      const RayHit hit = geometry.intersect(arriving);
      ASSERT_TRUE(hit.found());
      const SurfaceHit surface = geometry.surface(arriving, hit);
      Vec3 w = random.direction();
      if (dot(w, surface.geometric_normal) > 0) w = -w;
      const float chord = -2 * place.scale * dot(w, surface.geometric_normal);
      if (chord < 0.1f * place.scale) continue;
      const RayHit far = geometry.intersect({offset_origin(surface, w), w});
      if (!far.found() || std::abs(far.t - chord) > tolerance * place.scale) ++wrong;
    }
    EXPECT_EQ(wrong, 0) << "radius " << place.scale << ", " << place.remoteness << " times as far from the origin";
  }
}

}  // namespace
}  // namespace etendue
