#pragma once

#include <filesystem>
#include <vector>

#include "camera/camera.h"
#include "image/image.h"
#include "render/render_scene.h"
#include "render/settings.h"
#include "scene/scene.h"

namespace etendue {

using MaterialId = scene::Id<scene::Material>;

/// Builds a SceneDescription in code, one line a thing.
class SceneKit {
 public:
  MaterialId material(const scene::Surface& surface, const Spectrum& emission = Spectrum(0));
  MaterialId diffuse(const Spectrum& reflectance) { return material(scene::DiffuseMaterial{reflectance}); }
  /// Shines with this radiance from its front and reflects nothing.
  MaterialId emitter(const Spectrum& radiance) { return material(scene::NoReflection{}, radiance); }

  /// Parallelogram with its front on the side of edge_x × edge_y.
  void quad(const Point3& corner, const Vec3& edge_x, const Vec3& edge_y, MaterialId material);
  /// The same as a mesh of n × n cells.
  void quad_grid(const Point3& corner, const Vec3& edge_x, const Vec3& edge_y, int n, MaterialId material);
  void sphere(const Point3& center, float radius, MaterialId material);
  /// The sphere as flat triangles with corners on it, `rings` from pole to pole, twice as many around.
  void triangulated_sphere(const Point3& center, float radius, int rings, MaterialId material);
  void mesh(std::vector<Point3> positions, std::vector<std::array<std::uint32_t, 3>> triangles, MaterialId material,
            std::vector<Vec3> normals = {});
  void light(const scene::LightSource& source, const Transform& to_world = {});

  scene::Id<scene::Volume> volume(scene::Volume volume);
  scene::Id<scene::Medium> medium(scene::Medium medium);
  /// The shape added last holds the medium; around it is vacuum.
  void fill_last(scene::Id<scene::Medium> interior);
  /// The description's camera, which says no more than that, stands in the medium.
  void camera_in(scene::Id<scene::Medium> medium);

  const scene::SceneDescription& description() const { return scene_; }
  RenderScene compile(const CompileOptions& options = {}) const;

 private:
  scene::SceneDescription scene_;
};

/// Pinhole at `eye`; the picture reaches `half` to each side on the plane at distance 1.
Camera pinhole(const Point3& eye, const Point3& target, float half);

/// Square picture by plain path tracing with independent samples, so that the variances of its pixels are those of
/// their means, and pixels know nothing of each other.
RenderSettings square_settings(int size, int samples_per_pixel, int max_depth = kUnlimitedDepth);

/// Renders to the end. Fails the test if samples were invalid.
Picture render(const RenderScene& scene, const Camera& camera, const RenderSettings& settings);

/// Writes a map of float texels.
scene::EnvironmentLight environment_map(const std::filesystem::path& path, const Image& map);

}  // namespace etendue
