#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include "base/error.h"
#include "base/tests/output_failure.h"
#include "base/tests/temporary_folder.h"
#include "image/io.h"

namespace etendue {
namespace {

using testing::HasSubstr;

Picture noise_picture(int size) {
  Picture picture{Image(size, size), {}, {}};
  std::uint32_t state = 1;
  for (Spectrum& pixel : picture.beauty.pixels())
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f;
  return picture;
}

/// No file of this process grows past `bytes` while it lives: what a full disk looks like, without one.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int);
};

/// Mounts a file system of 64 KiB on `folder`, seen by this thread only. False where that is not permitted.
bool mount_tiny_disk(const std::filesystem::path& folder) {
  return unshare(CLONE_NEWNS) == 0 && mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=64k") == 0;
}

TEST(CheckWritable, SaysWhatWritingWouldSay) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "folder.png");
  for (const char* name : {"nowhere/a.png", "folder.png"}) {
    const std::string message = output_failure([&] { check_writable(folder / name, 2, 2); });
    EXPECT_THAT(message, HasSubstr((folder / name).string()));
    EXPECT_EQ(message, output_failure([&] { write_picture(folder / name, noise_picture(2)); }));
  }
}

class TornFile : public testing::TestWithParam<const char*> {};

TEST_P(TornFile, OlderFileStaysWholeWhenTheDiskFillsUp) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / (std::string("picture") + GetParam());
  write_bytes(path, "older");
  {
    const FileSizeLimit limit(1000);
    EXPECT_THAT(output_failure([&] { write_picture(path, noise_picture(64)); }), HasSubstr("make room"));
  }
  EXPECT_EQ(read_bytes(path), "older");
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST_P(TornFile, FullDiskIsNoticed) {
  const TemporaryFolder folder;
  if (!mount_tiny_disk(folder.path())) GTEST_SKIP() << "mounting a tiny disk is not permitted here";
  const std::filesystem::path path = folder / (std::string("picture") + GetParam());
  write_picture(path, noise_picture(16));
  const std::string before = read_bytes(path);
  EXPECT_THAT(output_failure([&] { write_picture(path, noise_picture(512)); }), HasSubstr("No space left on device"));
  EXPECT_EQ(read_bytes(path), before);
  EXPECT_EQ(folder.names().size(), 1u);
  umount(folder.path().c_str());
}

INSTANTIATE_TEST_SUITE_P(Formats, TornFile, testing::Values(".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".hdr"),
                         [](const auto& format) { return std::string(format.param + 1); });

}  // namespace
}  // namespace etendue
