#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "base/diagnostics.h"
#include "camera/camera.h"
#include "math/bounds.h"
#include "scene/scene.h"

namespace etendue {

enum class EnvironmentSampling { uniform, importance };

/// Choices that shape the compiled scene.
struct CompileOptions {
  std::optional<scene::Fresnel> fresnel;  ///< overrides every glass
  EnvironmentSampling environment_sampling = EnvironmentSampling::importance;
  bool light_tree = true;  ///< lights are chosen by what they may give to a place; else by power (LightChooser)
  /// Gives one more light, which may depend on the bounds of all that the description holds; none if empty.
  std::function<scene::Light(const Bounds3& bounds)> light_for = {};
};

/// A scene ready to be rendered: acceleration structure, BSDF inputs, lights. Immutable, shared by threads and
/// sessions.
class RenderScene {
 public:
  struct Data;  ///< what integrators read (render/scene_data.h)

  explicit RenderScene(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  const Data& data() const { return *data_; }

  const Bounds3& bounds() const;  ///< of all geometry, world space
  std::size_t triangle_count() const;
  std::size_t sphere_count() const;
  std::size_t light_count() const;
  double build_seconds() const;  ///< spent in compile

  /// Distance along the camera's axis to what the middle of pixel (x, y) of a width × height picture shows; nothing if
  /// it sees none.
  std::optional<float> depth_at(const Camera& camera, int x, int y, int width, int height) const;

 private:
  std::shared_ptr<const Data> data_;
};

/// Builds a RenderScene. Repairs (missing textures, degenerate triangles, singular transforms) are counted in
/// diagnostics; a scene without geometry or one that cannot be built is Error(Failure::input).
RenderScene compile(const scene::SceneDescription& scene, const CompileOptions& options, Diagnostics& diagnostics);

}  // namespace etendue
