#include "base/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/tests/output_failure.h"
#include "base/tests/temporary_folder.h"

namespace etendue {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

/// Acts as a user without special rights while it lives, where the tests run as root.
class OrdinaryUser {
 public:
  OrdinaryUser() : was_root_(geteuid() == 0) {
    if (was_root_ && seteuid(65534) != 0) throw std::runtime_error("cannot become another user");
  }
  ~OrdinaryUser() {
    if (was_root_) static_cast<void>(!seteuid(0));
  }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;

 private:
  bool was_root_;
};

TEST(OutputFile, WritesAndReplacesAndLeavesNothingElse) {
  const TemporaryFolder folder;
  write_whole_file(folder / "a.txt", bytes_of("first"));
  write_whole_file(folder / "a.txt", bytes_of("second"));
  EXPECT_EQ(read_bytes(folder / "a.txt"), "second");
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(OutputFile, NewFilesHaveTheUsersUsualPermissions) {
  const TemporaryFolder folder;
  const mode_t old = umask(022);
  write_whole_file(folder / "a.txt", bytes_of("text"));
  umask(old);
  struct stat status {};
  ASSERT_EQ(stat((folder / "a.txt").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0644u);
}

TEST(OutputFile, NameWithoutFolderMeansTheCurrentFolder) {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  write_whole_file("plain.txt", bytes_of("text"));
  std::filesystem::current_path(before);
  EXPECT_THAT(folder.names(), ElementsAre("plain.txt"));
}

TEST(OutputFile, MissingFolderIsNamedWithItsRemedy) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "nowhere/a.png";
  const std::string message = output_failure([&] { check_file_writable(path); });
  EXPECT_THAT(message, HasSubstr(path.string()));
  EXPECT_THAT(message, HasSubstr("No such file or directory"));
  EXPECT_THAT(message, HasSubstr("check that the folder exists"));
  EXPECT_EQ(message, output_failure([&] { write_whole_file(path, bytes_of("text")); }));
}

TEST(OutputFile, FolderInThePlaceOfTheFileIsRefused) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "a.png");
  EXPECT_THAT(output_failure([&] { check_file_writable(folder / "a.png"); }), HasSubstr("Is a directory"));
  EXPECT_THAT(output_failure([&] { write_whole_file(folder / "a.png", bytes_of("text")); }),
              HasSubstr("Is a directory"));
  EXPECT_THAT(folder.names(), ElementsAre("a.png"));
}

TEST(OutputFile, DevicesAndPipesAreRefusedAndStay) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe.png").c_str(), 0600), 0);
  EXPECT_THAT(output_failure([&] { check_file_writable(folder / "pipe.png"); }), HasSubstr("device or a pipe"));
  EXPECT_THAT(output_failure([&] { write_whole_file("/dev/full", bytes_of("text")); }), HasSubstr("device or a pipe"));
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe.png"));
}

TEST(OutputFile, FolderWithoutPermissionIsRefusedBeforeAndAfterRendering) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.png", "older");
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
  {
    const OrdinaryUser user;
    EXPECT_THAT(output_failure([&] { check_file_writable(folder / "a.png"); }), HasSubstr("Permission denied"));
    EXPECT_THAT(output_failure([&] { write_whole_file(folder / "a.png", bytes_of("text")); }),
                HasSubstr("Permission denied"));
  }
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
  EXPECT_EQ(read_bytes(folder / "a.png"), "older");
  EXPECT_THAT(folder.names(), ElementsAre("a.png"));
}

TEST(OutputFile, CheckLeavesNothingBehindAndTouchesNoOlderFile) {
  const TemporaryFolder folder;
  check_file_writable(folder / "new.png");
  EXPECT_THAT(folder.names(), IsEmpty());
  write_bytes(folder / "old.exr", "older");
  check_file_writable(folder / "old.exr");
  EXPECT_EQ(read_bytes(folder / "old.exr"), "older");
}

}  // namespace
}  // namespace etendue
