#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.h"
#include "testing/random.h"
#include "volumes/volume.h"

namespace etendue {

/// Files of volumes in a folder of this test.
class VolumeFiles : public ::testing::Test {
 protected:
  VolumeFiles()
      : folder_(std::filesystem::temp_directory_path() /
                ("etendue-vdb-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
                 ::testing::UnitTest::GetInstance()->current_test_info()->test_suite_name() +
                 ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }
  ~VolumeFiles() override { std::filesystem::remove_all(folder_); }

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

  /// Reads the file so many times, each time with eight other bytes in a row: that is refused, or does no harm.
  void lie_about(const std::string& bytes, std::uint64_t seed, int times) {
    Random random(seed);
    for (int i = 0; i < times; ++i) {
      std::string broken = bytes;
      // Half of the lies are in the headers, where each byte says much.
      const auto place =
          static_cast<std::size_t>(random.value() * static_cast<float>(i % 2 == 0 ? 1500 : broken.size()));
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

  std::filesystem::path folder_;
};

}  // namespace etendue
