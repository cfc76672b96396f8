#include "volumes/volume.h"

#include <gtest/gtest.h>

#include "testing/random.h"

namespace etendue {
namespace {

scene::Volume grid_of(scene::TextureFilter filter, scene::TextureWrap wrap, const Transform& to_world) {
  Random random(1);
  scene::GridVolume grid;
  grid.size = {3, 4, 5};
  grid.channels = 3;
  for (int i = 0; i < 3 * 4 * 5 * 3; ++i) grid.values.push_back(random.between(-1, 2));
  grid.filter = filter;
  grid.wrap = wrap;
  scene::Volume volume;
  volume.source = std::move(grid);
  volume.to_world = to_world;
  return volume;
}

const Transform kPlaced =
    Transform::rotation({1, 2, 3}, 0.7f) * Transform::translation({-1, 2, -1}) * Transform::scaling({2, 3, 2});

TEST(Volume, FillsTheUnitCubeOfItsSpace) {
  const scene::Volume description = grid_of(scene::TextureFilter::bilinear, scene::TextureWrap::clamp, kPlaced);
  const Volume volume(description);
  const auto& values = std::get<scene::GridVolume>(description.source).values;
  // The centre of cell (2, 1, 3), and half way to its neighbour along x.
  const auto at = [&](int x, int y, int z) { return values[((z * 4 + y) * 3 + x) * 3 + 1]; };
  EXPECT_NEAR(volume.lookup(kPlaced.point({2.5f / 3, 1.5f / 4, 3.5f / 5})).g, at(2, 1, 3), 1e-5f);
  EXPECT_NEAR(volume.lookup(kPlaced.point({2.0f / 3, 1.5f / 4, 3.5f / 5})).g, (at(1, 1, 3) + at(2, 1, 3)) / 2, 1e-5f);
  for (int axis = 0; axis < 3; ++axis) {
    const Bounds3 bounds = volume.bounds();
    EXPECT_LE(bounds.min[axis], kPlaced.point({0, 1, 1})[axis]);
    EXPECT_GE(bounds.max[axis], kPlaced.point({0, 1, 1})[axis]);
  }
}

TEST(Volume, RangesHoldAllThatIsFoundThere) {
  Random random(2);
  for (const auto filter : {scene::TextureFilter::bilinear, scene::TextureFilter::nearest})
    for (const auto wrap : {scene::TextureWrap::clamp, scene::TextureWrap::repeat, scene::TextureWrap::mirror})
      for (const Transform& placed : {Transform{}, kPlaced}) {
        const Volume volume(grid_of(filter, wrap, placed));
        for (int box = 0; box < 300; ++box) {
          Bounds3 bounds;
          bounds.extend(
              placed.point({random.between(-0.5f, 1.5f), random.between(-0.5f, 1.5f), random.between(-0.5f, 1.5f)}));
          bounds.extend(bounds.min + Vec3(random.value(), random.value(), random.value()) * 0.5f);
          const ValueRange range = volume.range(bounds);
          for (int i = 0; i < 50; ++i) {
            const Vec3 t(random.value(), random.value(), random.value());
            const Spectrum value = volume.lookup(bounds.min + t * (bounds.max - bounds.min));
            for (int c = 0; c < 3; ++c) {
              ASSERT_GE(value[c], range.min - 1e-5f);
              ASSERT_LE(value[c], range.max + 1e-5f);
            }
          }
        }
      }
}

TEST(Volume, RangesOfSmallBoxesAreSmall) {
  const Volume volume(grid_of(scene::TextureFilter::bilinear, scene::TextureWrap::clamp, {}));
  Bounds3 cell;
  cell.extend({1.5f / 3, 1.5f / 4, 1.5f / 5});
  cell.extend({2.0f / 3, 2.0f / 4, 2.0f / 5});
  const ValueRange all = volume.range(volume.bounds()), some = volume.range(cell);
  EXPECT_LT(some.max - some.min, all.max - all.min);
}

TEST(Volume, ConstantsAreTheSameEverywhere) {
  const Volume volume(Spectrum(1, 2, 3));
  EXPECT_EQ(volume.lookup({1e30f, 0, 0}), Spectrum(1, 2, 3));
  EXPECT_EQ(volume.range({}).min, 1);
  EXPECT_EQ(volume.range({}).max, 3);
  EXPECT_TRUE(volume.bounds().empty());
}

}  // namespace
}  // namespace etendue
