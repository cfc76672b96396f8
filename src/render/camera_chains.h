#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/camera_rays.h"
#include "render/vertex.h"

namespace etendue {

/// What the camera sees by way of mirrors and glass walls alone. Lamps have images there that are much smaller than a
/// pixel, and only rays from the camera can meet them: each that a path happens to meet is a white dot. Such chains
/// cost much less than paths, so more of them are followed beside each path, the ways that the path goes as well. All
/// that are there and the path's own count the same: the balance heuristic (Veach 1997, eq. 9.8) for techniques of one
/// density.
class CameraChains {
 public:
  /// The scene has to outlive it.
  CameraChains(const RenderScene::Data& scene, const CameraRays& camera_rays, const RenderSettings& settings);

  /// Whether there can be any, for all that is known before rays are traced.
  bool possible() const { return possible_; }

  /// Looks once for the places of the picture that show mirrors and glass, by rays of its own: whether chains are
  /// followed must not depend on what they find. Returns the rays traced.
  std::uint64_t look_ahead();

  /// Whether chains follow the darker way too where paths do and it is worth so much: the lamps that it leads to are
  /// bright dots as well. Of others the path's own find is better, which knows that there are two ways.
  static constexpr bool follows_branch(float worth) { return worth >= 0.1f; }

  /// Weight of a lamp that a path of this pixel, begun at `film` in it ([0,1)², before the reconstruction filter),
  /// meets after so many bounces, all by delta lobes, where chains go as well.
  float weight_of_found(int x, int y, const Vec2& film, int bounces) const;

  /// Adds what more chains find to samples first, first + 1, … of a pixel. Returns the rays traced.
  std::uint64_t follow(int x, int y, std::uint32_t first, std::span<PixelSample> samples) const;

 private:
  /// Cells along the side of a pixel, each with a bit of its mask, row by row.
  static constexpr int kSide = 4;
  using Mask = std::uint16_t;
  static Mask cell(const Vec2& film) {
    return static_cast<Mask>(1u << (static_cast<int>(film.y * kSide) * kSide + static_cast<int>(film.x * kSide)));
  }
  struct Chain;
  struct Chains;
  std::uint64_t look_at(int x, int y, Mask& seen) const;
  void widen(const std::vector<Mask>& seen);
  std::uint64_t trace(Chains& chains, const PixelSampler& sampler, std::uint32_t first,
                      std::span<PixelSample> samples) const;
  template <typename Draw>
  static void go_on(const Chain& chain, const Vertex& vertex, Chains& chains, const Draw& draw);
  std::uint64_t look_behind_lights(Ray& ray, RayHit& hit) const;
  /// Of pixel (x, y), where it is within the window; none elsewhere.
  Mask cells(int x, int y) const { return is_within(x, y) ? cells_[index(x, y)] : Mask{0}; }
  bool is_within(int x, int y) const {
    return x >= window_.x && x < window_.x + window_.width && y >= window_.y && y < window_.y + window_.height;
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - window_.y) * static_cast<std::size_t>(window_.width) +
           static_cast<std::size_t>(x - window_.x);
  }

  const RenderScene::Data& scene_;
  CameraRays camera_rays_;
  SamplerKind sampler_;
  std::uint64_t seed_;
  CropWindow window_;  ///< what is rendered of the picture, and a pixel around it
  int most_bounces_;
  bool hide_emitters_;
  bool possible_;
  std::vector<Mask> cells_;  ///< of each pixel of the window: those that show mirrors or glass
};

}  // namespace etendue
