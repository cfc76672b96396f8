#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/camera_rays.h"

namespace etendue {

/// What the camera sees by way of many mirrors and glass walls alone. Lamps have images there that are much smaller
/// than a pixel, and only rays from the camera can meet them: each that a path happens to meet is a white dot. Such
/// chains cost much less than paths, so more of them are followed wherever light is led on for long. All that are there
/// and the paths' own count the same: the balance heuristic (Veach 1997, eq. 9.8) for techniques of one density.
class LongChains {
 public:
  /// The scene has to outlive it.
  LongChains(const RenderScene::Data& scene, const CameraRays& camera_rays, const RenderSettings& settings);

  /// Whether there can be any, for all that is known before rays are traced.
  bool possible() const { return possible_; }

  /// Looks once for the places of the picture where chains are long, by rays of its own: whether others are followed
  /// must not depend on what they find. Returns the rays traced.
  std::uint64_t look_ahead();

  /// Weight of a lamp that a path of this pixel, begun at `film` in it ([0,1)², before the reconstruction filter),
  /// meets after so many bounces, all by delta lobes.
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
  struct Cells {
    Mask glass = 0;  ///< where the first surface sends light both ways
    Mask leads = 0;  ///< where most of the light is led on for long
  };
  int chains_beside(int x, int y, const Vec2& film) const;
  struct Chains;
  template <typename Choose, typename Meet>
  std::uint64_t trace(Chains& chains, int most_bounces, const Choose& choose, const Meet& meet) const;
  std::uint64_t look_at(int x, int y, Cells& found) const;
  void widen(const std::vector<Cells>& found, Mask Cells::*which);
  /// Of pixel (x, y), where it is within the window; 0 cells elsewhere.
  Cells cells(int x, int y) const { return is_within(x, y) ? cells_[index(x, y)] : Cells{}; }
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
  std::vector<Cells> cells_;  ///< of each pixel of the window
};

}  // namespace etendue
