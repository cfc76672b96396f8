#include "volumes/nvdb_file.h"

#include <blosc.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <optional>

#include <nanovdb/util/IO.h>

#include "base/error.h"

namespace etendue {
namespace {

namespace io = nanovdb::io;

constexpr std::uint32_t kLongestName = 4096;
/// The smallest grid there is, and how much zlib shrinks a file at the most; Blosc's LZ4 shrinks it less.
constexpr std::uint64_t kSmallestGrid = sizeof(nanovdb::GridData), kMostPacked = 1032;
/// NanoVDB hands Blosc so many bytes at a time.
constexpr std::size_t kBloscChunk = std::size_t{1} << 30;

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
    if (header.magic != NANOVDB_MAGIC_NUMBER) fail("is neither an OpenVDB nor a NanoVDB file");
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
    const bool is_packed = meta.codec == io::Codec::ZIP || meta.codec == io::Codec::BLOSC;
    if (!is_packed && meta.codec != io::Codec::NONE) fail("is packed in a way that is not known");
    const std::uint64_t stored = is_packed ? meta.fileSize : meta.gridSize;
    if (stored > left_ || meta.gridSize < kSmallestGrid || meta.gridSize / kMostPacked > stored)
      fail("ends in the middle of a grid");
    NvdbBytes grid(meta.gridSize);
    if (meta.codec == io::Codec::NONE)
      take(grid.bytes().data(), grid.bytes().size());
    else if (meta.codec == io::Codec::ZIP)
      unzip(grid.bytes());
    else
      unpack_blosc(grid.bytes());
    return grid;
  }

  void unzip(std::span<std::byte> grid) {
    const std::vector<Bytef> bytes = take_packed<Bytef>();
    uLongf size = grid.size();
    if (uncompress(reinterpret_cast<Bytef*>(grid.data()), &size, bytes.data(), bytes.size()) != Z_OK ||
        size != grid.size())
      fail_unpacking();
  }

  void unpack_blosc(std::span<std::byte> grid) {
    while (!grid.empty()) {
      const std::vector<char> bytes = take_packed<char>();
      const std::size_t chunk = std::min(grid.size(), kBloscChunk);
      std::size_t size = 0;
      if (blosc_cbuffer_validate(bytes.data(), bytes.size(), &size) < 0 || size != chunk ||
          blosc_decompress_ctx(bytes.data(), grid.data(), chunk, 1) != static_cast<int>(chunk))
        fail_unpacking();
      grid = grid.subspan(chunk);
    }
  }

  template <typename Byte>
  std::vector<Byte> take_packed() {
    const auto size = take<std::uint64_t>();
    if (size > left_) fail("ends in the middle of a grid");
    std::vector<Byte> bytes(size);
    take(bytes.data(), size);
    return bytes;
  }

  [[noreturn]] void fail_unpacking() const { fail("is damaged: a grid cannot be unpacked"); }

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
