#include "camera/settings_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "base/error.h"

namespace etendue {
namespace {

class SettingsFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("etendue-settings-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& text) const {
    std::ofstream(path(), std::ios::binary) << text;
    return path();
  }
  std::filesystem::path path() const { return folder_ / "camera.txt"; }

  /// The message of the error that reading `text` ends with; the file is one that may not be accepted.
  std::string failure(const std::string& text) const {
    write(text);
    try {
      read_camera_settings(path(), 800, 600);
    } catch (const Error& error) {
      EXPECT_EQ(error.failure(), Failure::input);
      return error.what();
    }
    ADD_FAILURE() << "accepted: " << text;
    return {};
  }

  std::filesystem::path folder_;
};

// As the teaching renderer writes them: six digits.
const std::string kViewing = "50 35.9834 1.43593 0.0101 10.1\n";
const std::string kPlace = "0.5 1.5 4\n0 1 0\n1.4488 0.124355 4.06202 0.4 80\n";
const std::string kMatrix = "1 0 0\n0 0.8 -0.6\n0 0.6 0.8\n";
const std::string kScreen = "480 334.278 514.7\n";
const std::string kLens = "4.7 0.0883\n";
const std::string kWhole = kViewing + kPlace + kMatrix + kScreen + kLens;

TEST_F(SettingsFile, ReadsTheTeachingRenderersFile) {
  const Camera camera = read_camera_settings(write(kWhole), 480, 334);
  EXPECT_NEAR(camera.tan_half_x, std::tan(radians(25.0f)), 2e-3f);
  EXPECT_NEAR(camera.tan_half_x / camera.tan_half_y, 480.0f / 334, 1e-5f);
  EXPECT_FLOAT_EQ(camera.near_clip, 0.0101f);
  EXPECT_FLOAT_EQ(camera.far_clip, 10.1f);
  EXPECT_EQ(camera.to_world.origin, Point3(0.5f, 1.5f, 4));
  EXPECT_NEAR(camera.to_world.y.z, 0.6f, 1e-6f) << "columns are right, up, back";
  EXPECT_NEAR(camera.to_world.z.y, -0.6f, 1e-6f);
  EXPECT_FLOAT_EQ(camera.focal_distance, 4.7f);
  EXPECT_FLOAT_EQ(camera.lens_radius, 0.0883f);
}

TEST_F(SettingsFile, OlderFilesHaveNoLens) {
  const Camera camera = read_camera_settings(write(kViewing + kPlace + kMatrix + kScreen), 480, 334);
  EXPECT_EQ(camera.lens_radius, 0);
  EXPECT_GT(camera.focal_distance, 0);
}

TEST_F(SettingsFile, FieldOfViewGrowsAlongTheTooNarrowSide) {
  write(kWhole);
  const float x = std::tan(radians(25.0f)), y = std::tan(radians(35.9834f / 2));
  const Camera wide = read_camera_settings(path(), 1000, 200);
  EXPECT_NEAR(wide.tan_half_y, y, 1e-5f);
  EXPECT_NEAR(wide.tan_half_x, 5 * y, 1e-4f);
  const Camera tall = read_camera_settings(path(), 200, 1000);
  EXPECT_NEAR(tall.tan_half_x, x, 1e-5f);
  EXPECT_NEAR(tall.tan_half_y, 5 * x, 1e-4f);
}

TEST_F(SettingsFile, ComesBackAsWritten) {
  Camera camera;
  camera.to_world = Transform::look_at({3, 2, -1}, {0.3f, 0.5f, 0.1f}, {0, 1, 0});
  camera.tan_half_x = 0.4f;
  camera.tan_half_y = 0.3f;
  camera.near_clip = 0.1f;
  camera.far_clip = 100;
  camera.lens_radius = 0.15f;
  camera.focal_distance = 4.5f;
  write_camera_settings(path(), camera, {0.3f, 0.5f, 0.1f}, 640, 480);
  const Camera back = read_camera_settings(path(), 640, 480);
  EXPECT_LT(length(back.to_world.origin - camera.to_world.origin), 1e-6f);
  EXPECT_LT(length(back.to_world.x - camera.to_world.x), 1e-6f);
  EXPECT_LT(length(back.to_world.y - camera.to_world.y), 1e-6f);
  EXPECT_LT(length(back.to_world.z - camera.to_world.z), 1e-6f);
  EXPECT_FLOAT_EQ(back.tan_half_x, camera.tan_half_x);
  EXPECT_FLOAT_EQ(back.tan_half_y, camera.tan_half_y);
  EXPECT_FLOAT_EQ(back.near_clip, camera.near_clip);
  EXPECT_FLOAT_EQ(back.far_clip, camera.far_clip);
  EXPECT_FLOAT_EQ(back.lens_radius, camera.lens_radius);
  EXPECT_FLOAT_EQ(back.focal_distance, camera.focal_distance);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1) << "no temporary file stays";
}

TEST_F(SettingsFile, APinholeWithoutFarPlaneComesBackToo) {
  write_camera_settings(path(), Camera{}, {0, 0, 0}, 800, 600);  // the target is the eye itself
  const Camera back = read_camera_settings(path(), 800, 600);
  EXPECT_EQ(back.far_clip, 0);
  EXPECT_EQ(back.lens_radius, 0);
}

TEST_F(SettingsFile, SaysWhichNumberIsMissing) {
  EXPECT_NE(failure("").find("the horizontal field of view (number 1 of 30) is missing"), std::string::npos);
  EXPECT_NE(failure(kViewing + "1 2").find(":2:4: error: the position z (number 8 of 30) is missing"),
            std::string::npos);
  EXPECT_NE(failure(kViewing + kPlace + kMatrix + kScreen + "4.7").find("lens radius (number 30 of 30) is missing"),
            std::string::npos);
}

TEST_F(SettingsFile, SaysWhatIsNoNumber) {
  const std::string message = failure("50 36\n1.3 near 100\n");
  EXPECT_NE(message.find("camera.txt:2:5: error: \"near\" stands where the near distance (number 4)"),
            std::string::npos)
      << message;
  failure("50,36 1.4");
  failure("0x10 1 1");
  failure(std::string("50 3\0 1", 7));
  failure(kWhole + "7");
}

TEST_F(SettingsFile, SaysWhichNumberIsImpossible) {
  EXPECT_NE(failure("180 36 1.3 0.1 100\n" + kPlace + kMatrix + kScreen).find("horizontal field of view (number 1)"),
            std::string::npos);
  failure("nan 36 1.3 0.1 100\n" + kPlace + kMatrix + kScreen);
  failure("50 36 -1.3 0.1 100\n" + kPlace + kMatrix + kScreen);
  failure("50 36 1.3 -0.1 100\n" + kPlace + kMatrix + kScreen);
  failure("50 36 1.3 10 5\n" + kPlace + kMatrix + kScreen);
  failure(kViewing + "1e300 1 1\n0 0 0\n0 0 0 0 0\n" + kMatrix + kScreen);
  failure(kViewing + kPlace + kMatrix + kScreen + "0 0.1");
  failure(kViewing + kPlace + kMatrix + kScreen + "1 -0.1");
}

TEST_F(SettingsFile, TheMatrixHasToBeARotation) {
  EXPECT_NE(failure(kViewing + kPlace + "1 0 0 0 1 0 0 0 0.5\n" + kScreen).find("no rotation"), std::string::npos);
  failure(kViewing + kPlace + "1 0 0 0 1 0 0 0 -1\n" + kScreen);  // mirrored
  failure(kViewing + kPlace + "0 0 0 0 0 0 0 0 0\n" + kScreen);
  failure(kViewing + kPlace + "1 0 0 0 7 0 0 0 1\n" + kScreen);
}

TEST_F(SettingsFile, GarbageIsRefusedWithoutReadingAllOfIt) {
  failure(std::string(1 << 20, '1'));
  failure(std::string(1 << 20, ' '));
  failure(
      "\x7f"
      "ELF\x01\x02\x03");
}

TEST_F(SettingsFile, MissingFilesAndFoldersAreErrors) {
  EXPECT_THROW(read_camera_settings(folder_ / "absent.txt", 8, 6), Error);
  EXPECT_THROW(read_camera_settings(folder_, 8, 6), Error);
  try {
    write_camera_settings(folder_ / "absent" / "camera.txt", Camera{}, {}, 8, 6);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.failure(), Failure::output);
  }
}

}  // namespace
}  // namespace etendue
