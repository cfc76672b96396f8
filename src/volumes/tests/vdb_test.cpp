#include <gmock/gmock.h>
#include <nanovdb/util/GridBuilder.h>
#define NANOVDB_USE_BLOSC
#define NANOVDB_USE_ZIP
#include <nanovdb/util/IO.h>

#include "volumes/tests/volume_files.h"

namespace etendue {
namespace {

using ::testing::HasSubstr;

float density_at(int x, int y, int z) {
  return static_cast<float>(1 + x % 7 + 2 * (y % 5) + std::abs(z));
}

class Vdb : public VolumeFiles {
 protected:
  /// Voxels from (−3, 0, 5) to (20, 10, 12), 0.5 m wide, the origin at (1, 2, 3): a density and a colour.
  std::filesystem::path write(nanovdb::io::Codec codec = nanovdb::io::Codec::NONE) {
    nanovdb::GridBuilder<float> density(0);
    nanovdb::GridBuilder<nanovdb::Vec3f> color(nanovdb::Vec3f(0));
    auto density_voxels = density.getAccessor();
    auto color_voxels = color.getAccessor();
    for (int z = 5; z <= 12; ++z)
      for (int y = 0; y <= 10; ++y)
        for (int x = -3; x <= 20; ++x) {
          density_voxels.setValue({x, y, z}, density_at(x, y, z));
          color_voxels.setValue({x, y, z}, nanovdb::Vec3f(1, 2, static_cast<float>(x)));
        }
    const auto path = folder_ / "grids.nvdb";
    std::vector<nanovdb::GridHandle<>> grids;
    grids.push_back(density.getHandle<>(0.5, nanovdb::Vec3d(1, 2, 3), "density"));
    grids.push_back(color.getHandle<>(0.5, nanovdb::Vec3d(1, 2, 3), "color"));
    nanovdb::io::writeGrids(path.string(), grids, codec);
    return path;
  }
};

TEST_F(Vdb, IsLookedUpInItsOwnSpace) {
  const Transform turned = Transform::rotation({0, 1, 0}, 1);
  const Volume volume = read(write(), "density", turned);
  const auto index = [&](float x, float y, float z) { return turned.point(Point3(1, 2, 3) + Vec3(x, y, z) * 0.5f); };
  EXPECT_NEAR(volume.lookup(index(4, 3, 8)).r, density_at(4, 3, 8), 1e-4f);
  EXPECT_NEAR(volume.lookup(index(4, 3.5f, 8)).r, (density_at(4, 3, 8) + density_at(4, 4, 8)) / 2, 1e-4f);
  EXPECT_EQ(volume.lookup(index(40, 3, 8)), Spectrum(0));
  const Bounds3 bounds = read(write(), "density").bounds();
  EXPECT_EQ(bounds.min, Point3(1 - 4 * 0.5f, 2 - 0.5f, 3 + 4 * 0.5f));
  EXPECT_EQ(bounds.max, Point3(1 + 21 * 0.5f, 2 + 11 * 0.5f, 3 + 13 * 0.5f));
}

TEST_F(Vdb, GridsAreFoundByName) {
  const auto file = write();
  EXPECT_EQ(read(file, "color").lookup({2, 3, 7}), Spectrum(1, 2, 2));
  EXPECT_EQ(read(file, "").lookup({2, 3, 7}), Spectrum(density_at(2, 2, 8)));
  EXPECT_THAT(message_for(file, "heat"), HasSubstr("holds no grid \"heat\"; there is \"density\", \"color\""));
  EXPECT_THAT(message_for(folder_ / "none.nvdb", ""), HasSubstr("cannot be opened"));
  EXPECT_THAT(message_for(write_bytes("not a grid, by any means"), ""),
              HasSubstr("is neither an OpenVDB nor a NanoVDB file"));
}

TEST_F(Vdb, PackedFilesHoldTheSame) {
  using nanovdb::io::Codec;
  const Volume plain = read(write(), "color");
  const auto size = std::filesystem::file_size(write());
  for (const Codec codec : {Codec::ZIP, Codec::BLOSC}) {
    const auto file = write(codec);
    EXPECT_LT(std::filesystem::file_size(file), size / 4);
    const Volume volume = read(file, "color");
    Random random(4);
    for (int i = 0; i < 500; ++i) {
      const Point3 p(random.between(-1, 12), random.between(1, 8), random.between(5, 10));
      ASSERT_EQ(volume.lookup(p), plain.lookup(p));
    }
  }
}

TEST_F(Vdb, PackedFilesThatLieDoNoHarm) {
  using nanovdb::io::Codec;
  for (const Codec codec : {Codec::ZIP, Codec::BLOSC}) {
    const std::string bytes = bytes_of(write(codec));
    for (const std::size_t length : {std::size_t{500}, bytes.size() / 2, bytes.size() - 1})
      EXPECT_THAT(message_for(write_bytes(bytes.substr(0, length)), "color"), HasSubstr("in the middle of a grid"));
    lie_about(bytes, 5, 400);
  }
}

TEST_F(Vdb, RangesHoldAllThatIsFoundThere) {
  const Volume volume = read(write(), "density");
  Random random(2);
  for (int box = 0; box < 200; ++box) {
    Bounds3 bounds;
    bounds.extend({random.between(-3, 14), random.between(0, 9), random.between(4, 11)});
    bounds.extend(bounds.min + Vec3(random.value(), random.value(), random.value()) * 2.0f);
    const ValueRange range = volume.range(bounds);
    for (int i = 0; i < 50; ++i) {
      const float value =
          volume.lookup(bounds.min + Vec3(random.value(), random.value(), random.value()) * (bounds.max - bounds.min))
              .r;
      ASSERT_GE(value, range.min - 1e-5f);
      ASSERT_LE(value, range.max + 1e-5f);
    }
  }
}

TEST_F(Vdb, TornFilesAreRefused) {
  const std::string bytes = bytes_of(write());
  for (const std::size_t length :
       {std::size_t{10}, std::size_t{100}, std::size_t{500}, std::size_t{5000}, bytes.size() - 1})
    EXPECT_NE(message_for(write_bytes(bytes.substr(0, length)), "color"), "") << length;
}

TEST_F(Vdb, LyingFilesAreRefusedOrReadWithoutHarm) {
  lie_about(bytes_of(write()), 3, 400);
}

}  // namespace
}  // namespace etendue
