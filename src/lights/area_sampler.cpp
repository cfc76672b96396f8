#include "lights/area_sampler.h"

#include <cmath>

#include "sampling/warp.h"

namespace etendue {
namespace {

/// How finely the area of a curved shape is summed: its element is smooth.
constexpr int kGrid = 16;

AreaPoint at_parameters(std::uint32_t shape, const ShapePoint& p, float a, float b, float pdf_parameters) {
  AreaPoint out;
  out.hit = {0, a, b, shape, 0, kNone};
  out.surface = {p.position, p.normal, p.normal, 0};
  out.pdf_area = pdf_parameters / length(cross(p.dp_da, p.dp_db));
  return out;
}

}  // namespace

AreaPoint mesh_point(const Geometry& geometry, std::uint32_t shape, std::uint32_t triangle, Vec2 b) {
  const TriangleMesh& mesh = geometry.mesh(shape);
  const auto& [i0, i1, i2] = mesh.triangles[triangle];
  const Point3 &p0 = mesh.positions[i0], &p1 = mesh.positions[i1], &p2 = mesh.positions[i2];
  AreaPoint out;
  out.hit = {0, b.x, b.y, shape, triangle, kNone};
  out.surface.position = p0 * (1 - b.x - b.y) + p1 * b.x + p2 * b.y;
  out.surface.geometric_normal = out.surface.shading_normal = normalize(cross(p1 - p0, p2 - p0));
  out.surface.error = kRelativeError * std::max({max_abs_component(p0), max_abs_component(p1), max_abs_component(p2)});
  return out;
}

AreaPoint sample_curved(const Geometry& geometry, std::uint32_t shape, Vec2 u) {
  AreaPoint out;
  float extent = 0;
  switch (geometry.kind(shape)) {
    case Geometry::Kind::disk: {
      const DiskShape& disk = geometry.disk(shape);
      const Vec2 p = sample_disk_concentric(u);
      out = at_parameters(shape, point_at(disk, p.x, p.y), p.x, p.y, disk_pdf());
      extent = max_abs_component(disk.to_world.origin);
      break;
    }
    case Geometry::Kind::cylinder: {
      const CylinderShape& cylinder = geometry.cylinder(shape);
      out = at_parameters(shape, point_at(cylinder, u.x, u.y), u.x, u.y, 1);
      extent = max_abs_component(cylinder.to_world.origin);
      break;
    }
    default: {
      const SphereShape& sphere = geometry.sphere(shape);
      const Vec3 w = sample_sphere_uniform(u);
      const Vec3 n = sphere.flip_normals ? -w : w;
      out.hit = {0, 0, 0, shape, 0, kNone};
      out.surface = {sphere.center + w * sphere.radius, n, n, 0};
      out.pdf_area = sphere_uniform_pdf() / square(sphere.radius);
      extent = max_abs_component(sphere.center) + sphere.radius;
    }
  }
  out.surface.error = kRelativeError * std::max(extent, max_abs_component(out.surface.position));
  return out;
}

AreaSampler::AreaSampler(const Geometry& geometry, std::uint32_t shape) : geometry_(&geometry), shape_(shape) {
  if (geometry.kind(shape) == Geometry::Kind::mesh) {
    const TriangleMesh& mesh = geometry.mesh(shape);
    std::vector<double> areas;
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      areas.push_back(0.5 *
                      length(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])));
      sum += areas.back();
    }
    triangles_ = DiscreteDistribution(areas);
    area_ = static_cast<float>(sum);
    return;
  }
  double sum = 0;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j)
      sum += 1 / sample_curved(geometry, shape,
                               {(static_cast<float>(i) + 0.5f) / kGrid, (static_cast<float>(j) + 0.5f) / kGrid})
                     .pdf_area;
  area_ = static_cast<float>(sum / (kGrid * kGrid));
}

AreaPoint AreaSampler::sample(Vec2 u, float choice) const {
  if (triangles_.size() == 0) return sample_curved(*geometry_, shape_, u);
  const auto triangle = static_cast<std::uint32_t>(triangles_.sample(choice).index);
  AreaPoint point = mesh_point(*geometry_, shape_, triangle, sample_triangle_uniform(u));
  point.pdf_area = 1 / area_;
  return point;
}

}  // namespace etendue
