#pragma once

#include "base/diagnostics.h"
#include "scene/scene.h"

namespace etendue {

/// Prints what has been collected since the last call, in order; errors are left to whoever catches them.
class DiagnosticsPrinter {
 public:
  explicit DiagnosticsPrinter(const Diagnostics& diagnostics) : diagnostics_(diagnostics) {}
  ~DiagnosticsPrinter() { print(); }  // whatever an exception cut short has been collected for the user, too
  DiagnosticsPrinter(const DiagnosticsPrinter&) = delete;
  DiagnosticsPrinter& operator=(const DiagnosticsPrinter&) = delete;

  void print();

 private:
  const Diagnostics& diagnostics_;
  std::size_t printed_ = 0;
};

/// Whether the instance's surface shines.
bool emits(const scene::SceneDescription& scene, const scene::Instance& instance);

/// Whether anything in the scene shines.
bool has_light(const scene::SceneDescription& scene);

/// Whether anything that shines fills a solid angle, so that a ray can meet it by chance: not a point, a spot or a
/// single direction.
bool has_light_with_extent(const scene::SceneDescription& scene);

}  // namespace etendue
