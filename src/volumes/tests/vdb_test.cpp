#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "testing/random.h"
#include "volumes/volume.h"

namespace etendue {
namespace {

using ::testing::HasSubstr;

float density_at(int x, int y, int z) {
  return static_cast<float>(1 + x % 7 + 2 * (y % 5) + std::abs(z));
}

/// Files in a folder of this test.
class Vdb : public ::testing::Test {
 protected:
  Vdb()
      : folder_(std::filesystem::temp_directory_path() /
                ("etendue-vdb-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
                 ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }
  ~Vdb() override { std::filesystem::remove_all(folder_); }

  /// Voxels from (−3, 0, 5) to (20, 10, 12), 0.5 m wide, the origin at (1, 2, 3): a density and a colour.
  std::filesystem::path write() {
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
    nanovdb::io::writeGrids(path.string(), grids);
    return path;
  }

  std::filesystem::path write_bytes(const std::string& bytes) {
    const auto path = folder_ / "broken.nvdb";
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  static Volume read(const std::filesystem::path& file, const std::string& grid, const Transform& to_world = {}) {
    scene::Volume volume;
    volume.source = scene::VdbVolume{file, grid};
    volume.to_world = to_world;
    return Volume(volume);
  }

  static std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  static std::string message_for(const std::filesystem::path& file, const std::string& grid) {
    try {
      read(file, grid);
    } catch (const Error& error) {
      EXPECT_EQ(error.failure(), Failure::input);
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
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
  EXPECT_THAT(message_for(write_bytes("not a grid, by any means"), ""), HasSubstr("is no NanoVDB file"));
  EXPECT_THAT(message_for(write_bytes(std::string("\x20\x42\x44\x56\0\0\0\0 and more", 17)), ""),
              HasSubstr("nanovdb_convert"));
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
  const std::string bytes = bytes_of(write());
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    std::string broken = bytes;
    // Half of the lies are in the headers, where each byte says much.
    const auto place = static_cast<std::size_t>(random.value() * static_cast<float>(i % 2 == 0 ? 1500 : broken.size()));
    for (std::size_t j = 0; j < 8 && place + j < broken.size(); ++j)
      broken[place + j] = static_cast<char>(random.between(-128, 127));
    try {
      const Volume volume = read(write_bytes(broken), "");
      volume.range(volume.bounds());
      for (int k = 0; k < 20; ++k)
        volume.lookup({random.between(-5, 15), random.between(-5, 15), random.between(-5, 15)});
    } catch (const Error& error) {
      EXPECT_EQ(error.failure(), Failure::input);
    }
  }
}

}  // namespace
}  // namespace etendue
