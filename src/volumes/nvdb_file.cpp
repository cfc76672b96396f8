#include "volumes/nvdb_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <fstream>
#include <optional>

#include <nanovdb/util/IO.h>

#include "base/error.h"

namespace etendue {
namespace {

namespace io = nanovdb::io;

constexpr std::uint64_t kOpenVdb = 0x56444220;  // the first eight bytes of a .vdb file
constexpr std::uint32_t kLongestName = 4096;
/// The smallest grid there is, and how much zlib shrinks a file at the most.
constexpr std::uint64_t kSmallestGrid = sizeof(nanovdb::GridData), kMostPacked = 1032;

class NvdbFile {
 public:
  NvdbFile(const std::filesystem::path& path, const std::string& wanted)
      : path_(path), wanted_(wanted), in_(path, std::ios::binary) {
    if (!in_) throw Error(Failure::input, fmt::format("{}: the file cannot be opened.", path.string()));
    left_ = std::filesystem::file_size(path);
  }

  NvdbBytes read() {
    while (left_ > 0)
      if (const std::optional<io::MetaData> found = find_in_segment()) return unpack(*found);
    if (names_.empty()) fail("holds no grid");
    fail(fmt::format("holds no grid \"{}\"; there is {}", wanted_, names_));
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Failure::input, fmt::format("{}: the file {}.", path_.string(), what));
  }

  void take(void* to, std::uint64_t size) {
    if (size > left_ || !in_.read(static_cast<char*>(to), static_cast<std::streamsize>(size)))
      fail("ends in the middle of a grid");
    left_ -= size;
  }
  void skip(std::uint64_t size) {
    if (size > left_) fail("ends in the middle of a grid");
    in_.seekg(static_cast<std::streamoff>(size), std::ios::cur);
    left_ -= size;
  }
  template <typename T>
  T take() {
    T value;
    take(&value, sizeof(T));
    return value;
  }

  /// Goes to the wanted grid if the next segment has it, else behind the segment.
  std::optional<io::MetaData> find_in_segment() {
    const auto header = take<io::Header>();
    if (header.magic == kOpenVdb)
      fail("is an OpenVDB file, and only NanoVDB's are read: nanovdb_convert makes one of it");
    if (header.magic != NANOVDB_MAGIC_NUMBER) fail("is no NanoVDB file");
    if (header.version.getMajor() != NANOVDB_MAJOR_VERSION_NUMBER)
      fail(fmt::format("is of NanoVDB's version {}, and only {} is read", header.version.getMajor(),
                       NANOVDB_MAJOR_VERSION_NUMBER));
    std::optional<io::MetaData> found;
    std::uint64_t before = 0, all = 0;
    for (int i = 0; i < header.gridCount; ++i) {
      const auto meta = take<io::MetaData>();
      const std::string name = take_name(meta.nameSize);
      if (!found && (wanted_.empty() || name == wanted_)) {
        found = meta;
        before = all;
      }
      names_ += fmt::format("{}\"{}\"", names_.empty() ? "" : ", ", name);
      if (meta.fileSize > left_) fail("ends in the middle of a grid");
      all += meta.fileSize;
    }
    skip(found ? before : all);
    return found;
  }

  std::string take_name(std::uint32_t size) {
    if (size > kLongestName) fail("has a grid whose name has more than 4096 letters");
    std::string name(size, '\0');
    take(name.data(), size);
    return name.substr(0, name.find('\0'));
  }

  NvdbBytes unpack(const io::MetaData& meta) {
    const bool zip = meta.codec == io::Codec::ZIP;
    if (!zip && meta.codec != io::Codec::NONE)
      fail("is packed by Blosc, which is not read; write it without compression or with ZIP");
    const std::uint64_t packed = zip ? take<std::uint64_t>() : meta.gridSize;
    if (packed > left_ || meta.gridSize < kSmallestGrid || meta.gridSize / kMostPacked > packed)
      fail("ends in the middle of a grid");
    NvdbBytes grid(meta.gridSize);
    if (!zip) {
      take(grid.bytes().data(), packed);
      return grid;
    }
    std::vector<Bytef> bytes(packed);
    take(bytes.data(), packed);
    uLongf size = meta.gridSize;
    if (uncompress(reinterpret_cast<Bytef*>(grid.bytes().data()), &size, bytes.data(), packed) != Z_OK ||
        size != meta.gridSize)
      fail("is damaged: a grid cannot be unpacked");
    return grid;
  }

  const std::filesystem::path& path_;
  const std::string& wanted_;
  std::ifstream in_;
  std::uint64_t left_ = 0;
  std::string names_;
};

}  // namespace

NvdbBytes read_nvdb_file(const std::filesystem::path& file, const std::string& grid) {
  return NvdbFile(file, grid).read();
}

}  // namespace etendue
