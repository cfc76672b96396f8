// What each further bounce brings to a box with a glass and a mirror sphere: the sequence that the profile describes.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "camera/placement.h"
#include "formats/formats.h"
#include "picture_statistics.h"
#include "scene_kit.h"

namespace etendue {
namespace {

constexpr int kWidth = 160, kHeight = 120;
const Spectrum kLampRadiance(10, 9.2f, 8);

struct Ball {
  Point3 center;
  float radius;
};

/// Distance along a ray to a ball; nothing if it misses.
std::optional<float> meet(const Ray& ray, const Ball& ball) {
  const Vec3 to_center = ball.center - ray.origin;
  const float along = dot(to_center, ray.direction);
  const float inside = square(ball.radius) - (length_squared(to_center) - square(along));
  if (inside < 0 || along < 0) return std::nullopt;
  return along - std::sqrt(inside);
}

/// How close a ray passes by a ball's centre, in radii.
float miss_distance(const Ray& ray, const Ball& ball) {
  const Vec3 to_center = ball.center - ray.origin;
  const float along = dot(to_center, ray.direction);
  if (along < 0) return std::numeric_limits<float>::infinity();
  return std::sqrt(std::max(length_squared(to_center) - square(along), 0.0f)) / ball.radius;
}

Ray reflected(const Ray& ray, const Ball& ball) {
  const Point3 p = ray.at(*meet(ray, ball));
  const Vec3 n = normalize(p - ball.center);
  return {p, ray.direction - n * (2 * dot(ray.direction, n))};
}

class Depth : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    Diagnostics diagnostics;
    const scene::SceneDescription description = read_scene(SCENES_FOLDER "/cornell-spheres.dae", diagnostics);
    for (const scene::Instance& instance : description.instances) {
      if (const auto* id = std::get_if<scene::Id<scene::Sphere>>(&instance.shape)) {
        const Ball ball{instance.to_world.origin, description.spheres[id->index].radius};
        const scene::Surface& surface = description.materials[instance.material.index].surface;
        (std::holds_alternative<scene::GlassMaterial>(surface) ? glass_ : mirror_) = ball;
      } else if (scene::emits(description.materials[instance.material.index])) {
        for (const Point3& p : description.meshes[std::get<scene::Id<scene::Mesh>>(instance.shape).index].positions)
          lamp_.extend(instance.to_world.point(p));
      }
    }
    scene_.emplace(compile(description, {scene::Fresnel::exact}, diagnostics));
    floor_height_ = scene_->bounds().min.y;
    camera_ = place_camera(description, scene_->bounds(), CameraPlacement::file, kWidth, kHeight, diagnostics);
  }
  static void TearDownTestSuite() {
    pictures_.clear();
    scene_.reset();
  }

  /// The picture with this depth, each with a seed of its own; made when a test first asks for it.
  static const SampledPicture& sampled(int depth) {
    if (!pictures_.contains(depth)) {
      RenderSettings settings;
      settings.width = kWidth;
      settings.height = kHeight;
      settings.samples_per_pixel = depth < 2 ? 16 : 64;
      settings.max_depth = depth;
      settings.seed = static_cast<std::uint64_t>(depth);
      pictures_.emplace(depth, sampled_picture(render(*scene_, camera_, settings)));
    }
    return pictures_.at(depth);
  }
  static const Image& picture(int depth) { return sampled(depth).mean; }

  static Ray ray_at(float x, float y) { return generate_ray(camera_, {x / kWidth, y / kHeight}, {0.5f, 0.5f}); }
  static Ray ray_through(int x, int y) { return ray_at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f); }

  /// Pixels well within the part of a ball's disk that is `share` of its radius.
  static PixelPredicate disk(const Ball& ball, float share) {
    return [ball, share](int x, int y) { return miss_distance(ray_through(x, y), ball) < share; };
  }
  /// Pixels that show level ground around a point, and nothing before it.
  static PixelPredicate patch(const Point3& center, float radius) {
    return [center, radius](int x, int y) {
      const Ray ray = ray_through(x, y);
      if (ray.direction.y >= 0 || meet(ray, glass_) || meet(ray, mirror_)) return false;
      const Point3 p = ray.at((center.y - ray.origin.y) / ray.direction.y);
      return length(p - center) < radius;
    };
  }
  static PixelPredicate everything() {
    return [](int, int) { return true; };
  }

  static RegionMean at_depth(int depth, const PixelPredicate& region) {
    return region_luminance(sampled(depth), region);
  }

  template <typename Action>
  static void for_pixels(const PixelPredicate& region, const Action& action) {
    int count = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (region(x, y)) {
          action(x, y);
          ++count;
        }
    ASSERT_GT(count, 0);
  }

  /// The share of a region's pixels whose luminance is above `level`.
  static double share_above(int depth, const PixelPredicate& region, float level) {
    double above = 0, all = 0;
    for_pixels(region, [&](int x, int y) {
      above += picture(depth).at(x, y).luminance() > level;
      ++all;
    });
    return above / all;
  }

  /// How many of a pixel's corners show the lamp, grown by `margin`, along `follow(ray through the corner)`.
  static int corners_on_lamp(int x, int y, float margin, const std::function<std::optional<Ray>(const Ray&)>& follow) {
    int count = 0;
    for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)}) {
      const std::optional<Ray> ray = follow(ray_at(static_cast<float>(x + dx), static_cast<float>(y + dy)));
      if (!ray || ray->direction.y <= 0) continue;
      const Point3 p = ray->at((lamp_.min.y - ray->origin.y) / ray->direction.y);
      count += p.x > lamp_.min.x - margin && p.x < lamp_.max.x + margin && p.z > lamp_.min.z - margin &&
               p.z < lamp_.max.z + margin;
    }
    return count;
  }

  static constexpr std::array<int, 7> kDepths = {0, 1, 2, 3, 4, 5, 100};
  static inline std::optional<RenderScene> scene_;
  static inline Ball glass_{}, mirror_{};
  static inline Bounds3 lamp_{};
  static inline float floor_height_ = 0;
  static inline Camera camera_{};
  static inline std::map<int, SampledPicture> pictures_;
};

TEST_F(Depth, ZeroShowsTheLampAndNothingElse) {
  int on_lamp = 0;
  for_pixels(everything(), [&](int x, int y) {
    const auto straight = [](const Ray& ray) { return std::optional(ray); };
    if (corners_on_lamp(x, y, -0.02f, straight) == 4) {
      ++on_lamp;
      EXPECT_EQ(picture(0).at(x, y), kLampRadiance) << x << ", " << y;
    } else if (corners_on_lamp(x, y, 0.02f, straight) == 0) {
      EXPECT_EQ(picture(0).at(x, y), Spectrum(0)) << x << ", " << y;
    }
  });
  EXPECT_GT(on_lamp, 20);
}

TEST_F(Depth, OneShowsOnlyTheLampsHighlightOnMirrorAndGlass) {
  for (const Ball& ball : {mirror_, glass_}) {
    int highlight = 0, black = 0;
    const auto reflection = [&](const Ray& ray) {
      return meet(ray, ball) ? std::optional(reflected(ray, ball)) : std::nullopt;
    };
    for_pixels(disk(ball, 0.95f), [&](int x, int y) {
      if (corners_on_lamp(x, y, -0.05f, reflection) == 4) {
        ++highlight;
        EXPECT_GT(picture(1).at(x, y).luminance(), 0) << x << ", " << y;
      } else if (corners_on_lamp(x, y, 0.15f, reflection) == 0) {
        ++black;
        EXPECT_EQ(picture(1).at(x, y), Spectrum(0)) << x << ", " << y;
      }
    });
    EXPECT_GE(highlight, 4);
    EXPECT_GT(black, 500);
  }
  // Meanwhile the floor has its direct light.
  const float mirror_side = -0.5f * lamp_.max.x;
  EXPECT_GT(at_depth(1, patch({mirror_side, floor_height_, 0.6f}, 0.15f)).mean, 0.05);
}

TEST_F(Depth, TwoShowsTheRoomInTheMirrorButNotThroughTheGlass) {
  // The middle of the mirror shows the box' open side, where nothing is.
  EXPECT_GT(share_above(2, disk(mirror_, 0.9f), 0.02f), 0.5);
  EXPECT_LT(share_above(1, disk(mirror_, 0.9f), 0.02f), 0.05);
  // What glass shows now is the room's faint reflection, not what lies behind it.
  const PixelPredicate middle = disk(glass_, 0.6f);
  EXPECT_GT(at_depth(2, middle).mean, 0);
  EXPECT_LT(at_depth(2, middle).mean, 0.2 * at_depth(3, middle).mean);
}

TEST_F(Depth, ThreeShowsTheRoomThroughTheGlassAndItsFocusOnTheFloor) {
  EXPECT_GT(share_above(3, disk(glass_, 0.6f), 0.05f), 0.9);
  // Beneath the ball, where the line from the lamp's middle through its centre meets the floor, its shadow becomes its
  // focus.
  const Vec3 down = normalize(glass_.center - lamp_.center());
  const Point3 focus = glass_.center + down * ((floor_height_ - glass_.center.y) / down.y);
  const PixelPredicate region = patch(focus, 0.12f);
  const RegionMean before = at_depth(2, region), after = at_depth(3, region);
  EXPECT_GT(after.mean, 2 * before.mean);
  EXPECT_LT(after.p_value(before), 1e-6);
  // Elsewhere on the floor one more bounce changes little.
  const PixelPredicate open = patch({-0.5f * lamp_.max.x, floor_height_, 0.6f}, 0.15f);
  EXPECT_LT(at_depth(3, open).mean, 1.4 * at_depth(2, open).mean);
}

TEST_F(Depth, FourLightsUpTheGlassInTheMirror) {
  const PixelPredicate glass_in_mirror = [](int x, int y) {
    const Ray ray = ray_through(x, y);
    return miss_distance(ray, mirror_) < 0.97f && miss_distance(reflected(ray, mirror_), glass_) < 0.6f;
  };
  const RegionMean two = at_depth(2, glass_in_mirror), three = at_depth(3, glass_in_mirror),
                   four = at_depth(4, glass_in_mirror);
  EXPECT_LT(two.mean, 0.25 * four.mean);
  EXPECT_LT(three.mean, 0.4 * four.mean);
  EXPECT_LT(four.p_value(three), 1e-6);
}

TEST_F(Depth, NoBounceTakesLightAway) {
  const std::map<std::string, PixelPredicate> regions = {
      {"the picture", everything()},
      {"the mirror", disk(mirror_, 0.95f)},
      {"the glass", disk(glass_, 0.95f)},
      {"the floor", patch({0, floor_height_, 0.5f}, 0.3f)},
      {"the left half", [](int x, int) { return x < kWidth / 2; }},
      {"the top", [](int, int y) { return y < kHeight / 4; }},
      {"the bottom", [](int, int y) { return y >= kHeight * 3 / 4; }}};
  TestFamily tests;
  for (const auto& [name, region] : regions)
    for (std::size_t i = 1; i < kDepths.size(); ++i) {
      const RegionMean less = at_depth(kDepths[i - 1], region), more = at_depth(kDepths[i], region);
      const double fall = std::max(less.mean - more.mean, 0.0);
      tests.add(fmt::format("{}, depth {}: {} after {}", name, kDepths[i], more.mean, less.mean),
                RegionMean{fall, std::hypot(less.error, more.error)}.p_value(0));
    }
  EXPECT_TRUE(tests.holds());
  // And the light does grow where it should: each of the first bounces is seen.
  for (std::size_t i = 1; i < kDepths.size(); ++i)
    EXPECT_GT(at_depth(kDepths[i], everything()).mean, at_depth(kDepths[i - 1], everything()).mean) << kDepths[i];
}

}  // namespace
}  // namespace etendue
