#include "base/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include "base/error.h"

namespace etendue {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  const std::string reason = std::generic_category().message(error);
  const char* remedy = error == ENOSPC || error == EDQUOT || error == EFBIG
                           ? "make room or choose another place"
                           : "check that the folder exists and may be written to, or choose another place";
  throw Error(Failure::output, fmt::format("cannot write {}: {}; {}", path.string(), reason, remedy));
}

/// A new file beside `path` that is removed again unless it was renamed to `path`.
class PartialFile {
 public:
  explicit PartialFile(const std::filesystem::path& path) : path_(path) {
    static std::atomic<int> count = 0;
    name_ = path.parent_path() / fmt::format(".{}.partial-{}-{}", path.filename().string(), getpid(), count++);
    std::error_code ignored;
    if (std::filesystem::is_directory(path_, ignored)) fail(path_, EISDIR);
    descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail(path_, errno);
  }
  ~PartialFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!renamed_) unlink(name_.c_str());
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  void write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(path_, errno);
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }

  void commit() {
    if (fsync(descriptor_) != 0) fail(path_, errno);
    if (close(std::exchange(descriptor_, -1)) != 0) fail(path_, errno);
    if (rename(name_.c_str(), path_.c_str()) != 0) fail(path_, errno);
    renamed_ = true;
  }

 private:
  std::filesystem::path path_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

/// A device or a pipe is refused: the rename would put a file in its place.
void refuse_special(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_other(path, ignored))
    throw Error(Failure::output,
                fmt::format("cannot write {}: it is a device or a pipe; choose a file", path.string()));
}

}  // namespace

void write_whole_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  refuse_special(path);
  PartialFile file(path);
  file.write(bytes);
  file.commit();
}

void check_file_writable(const std::filesystem::path& path) {
  refuse_special(path);
  const PartialFile file(path);
}

}  // namespace etendue
