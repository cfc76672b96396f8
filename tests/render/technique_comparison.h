#pragma once

#include <span>
#include <string>

#include "scene_kit.h"

namespace etendue {

struct Place {
  SceneKit kit;
  Camera camera;
};

MaterialId glass(SceneKit& kit);
MaterialId mirror(SceneKit& kit);
MaterialId steel(SceneKit& kit, float alpha);
/// A box with its front inside.
void room(SceneKit& kit, const Point3& low, const Point3& high, MaterialId material);

struct Technique {
  std::string name;
  IntegratorKind integrator = IntegratorKind::path;
  Use photons = Use::off, reuse = Use::off, cache = Use::off;
  SamplerKind sampler = SamplerKind::sobol;
  Use splitting = Use::automatic;
  std::uint64_t memory_limit = RenderSettings().memory_limit;
  Use airlight = Use::off;
};
/// The same settings with this technique.
RenderSettings with(const Technique& technique, RenderSettings settings);

/// What of a picture is looked at, and how well.
struct Look {
  int whole_side = 512;  ///< of the picture, in pixels: photons reach as far as they are wide, and so do cells
  int side = 32;         ///< of its part in the middle that is rendered
  int depth = kUnlimitedDepth;
  int plain_samples = 512, samples = 256;
  int seeds = 16;
  double quarter_error = 0.012;  ///< standard error that a quarter's mean may have, relative
  double blur = 0;  ///< share of its mean that a technique carries across the border of the part or a quarter
};

/// A small picture as a whole, for techniques that carry nothing far; `samples` of theirs for 128 of plain paths.
Look small_look(int samples, int depth);

/// Expects the means of all techniques to be those of plain path tracing. Pixels of such pictures know of each other,
/// so seeds are what is compared. Precise enough to see an error of 1 % of the whole, and of a few per cent of a
/// quarter.
void expect_same_means(const Place& place, std::span<const Technique> techniques, const Look& look);

}  // namespace etendue
