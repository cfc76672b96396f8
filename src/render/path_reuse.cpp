#include "render/path_reuse.h"

#include "render/direct_light.h"

namespace etendue {
namespace {

/// A path's view of a second vertex, its own or another's.
struct View {
  int path;
  Spectrum f_cos;     ///< of the path's first vertex
  float pdf_area;     ///< with which that path would have found the second vertex, per m²
  float to_area = 0;  ///< solid angle at the first vertex / area at the second
};

/// From which side a surface is seen, by its true and its interpolated normal: Lambertian surfaces look the same only
/// within the same.
int side_of(const SurfaceHit& surface, const Vec3& to_viewer) {
  return (dot(surface.geometric_normal, to_viewer) > 0 ? 1 : 0) | (dot(surface.shading_normal, to_viewer) > 0 ? 2 : 0);
}

float area_per_solid_angle(const SurfaceHit& surface, const Vec3& d) {
  const float d2 = length_squared(d);
  return std::abs(dot(surface.geometric_normal, d)) / (d2 * std::sqrt(d2));
}

/// The views that neighbours have of one second vertex.
class Views {
 public:
  Views(std::span<const SharedPath* const> paths, int owner) : paths_(paths), shown_(*paths[owner]) {
    const Vec3 own = shown_.second.position - shown_.first.surface.position;
    side_ = side_of(shown_.second, -own);
    const float to_area = area_per_solid_angle(shown_.second, own);
    views_[count_++] = {owner, shown_.f_cos, shown_.pdf * to_area, to_area};
    for (int p = 0; p < static_cast<int>(paths.size()); ++p)
      if (p != owner && paths[p]->has_first && paths[p]->depth == shown_.depth) look(p);
  }

  std::span<const Ray> rays() const { return {rays_, static_cast<std::size_t>(count_ - 1)}; }

  /// `blocked`: bit i for rays()[i].
  void add_to(std::span<PixelSample* const> samples, std::uint32_t blocked) const {
    const auto sees = [&](int view) { return view == 0 || (blocked >> (view - 1) & 1u) == 0; };
    float pdf = 0;
    for (int v = 0; v < count_; ++v)
      if (sees(v)) pdf += views_[v].pdf_area;
    if (!(pdf > 0)) return;
    for (int v = 0; v < count_; ++v) {
      if (!sees(v)) continue;
      const View& view = views_[v];
      samples[view.path]->radiance +=
          paths_[view.path]->throughput * view.f_cos * shown_.radiance * (view.to_area / pdf);
    }
  }

 private:
  void look(int path) {
    const Vertex& first = paths_[path]->first;
    const Vec3 d = shown_.second.position - first.surface.position;
    const float distance = length(d);
    if (!(distance > 0) || side_of(shown_.second, -d) != side_) return;
    const Vec3 wi = d * (1 / distance);
    const BsdfEval eval = first.scattering.eval(wi);
    if ((paths_[path]->throughput * eval.f_cos).is_black()) return;  // nor would it have gone there
    const float to_area = area_per_solid_angle(shown_.second, d);
    const Vec3 normal = (side_ & 1) != 0 ? shown_.second.geometric_normal : -shown_.second.geometric_normal;
    const LightSample end{wi, distance, {}, 1, false, normal, shown_.second.error};
    rays_[count_ - 1] = shadow_ray(offset_origin(first.surface, wi), first.surface.position, end);
    views_[count_++] = {path, eval.f_cos, eval.pdf * to_area, to_area};
  }

  std::span<const SharedPath* const> paths_;
  const SharedPath& shown_;
  int side_ = 0;
  int count_ = 0;
  View views_[Geometry::kBatch];
  Ray rays_[Geometry::kBatch];
};

}  // namespace

std::uint64_t share_paths(const Geometry& geometry, std::span<const SharedPath* const> paths,
                          std::span<PixelSample* const> samples) {
  std::uint64_t traced = 0;
  for (int i = 0; i < static_cast<int>(paths.size()); ++i) {
    if (!paths[i]->has_second || paths[i]->radiance.is_black()) continue;
    const Views views(paths, i);
    const std::span<const Ray> rays = views.rays();
    views.add_to(samples, rays.empty() ? 0 : geometry.occluded(rays));
    traced += rays.size();
  }
  return traced;
}

}  // namespace etendue
