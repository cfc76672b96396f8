#include "volumes/openvdb_file.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>

#include <cstring>
#include <fstream>

#include <nanovdb/util/OpenToNanoVDB.h>

#include "base/error.h"

namespace etendue {
namespace {

using openvdb::GridBase;
using openvdb::io::GridDescriptor;

constexpr std::uint64_t kMagic = 0x56444220;  // the first eight bytes of a .vdb file
constexpr std::uint32_t kOldestFormat = openvdb::OPENVDB_FILE_VERSION_BOOST_UUID;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw Error(Failure::input, fmt::format("{}: {}.", file.string(), what));
}

/// A .vdb file, read from front to back until a grid is found. OpenVDB's own io::File believes the sizes in a file,
/// and takes what follows the end of a torn one for a grid; here sizes are looked at first, and the stream throws.
class OpenVdbFile : public openvdb::io::Archive {
 public:
  explicit OpenVdbFile(const std::filesystem::path& path)
      : path_(path), in_(path, std::ios::binary), size_(std::filesystem::file_size(path)) {
    in_.exceptions(std::ios::failbit | std::ios::badbit);
    check_format();
    readHeader(in_);
    setFormatVersion(in_);
    setLibraryVersion(in_);
    setDataCompression(in_);
    check_metadata();
    openvdb::MetaMap().readMeta(in_);
  }

  GridBase::Ptr read(const std::string& wanted) {
    std::string names;
    for (int left = readGridCount(in_); left > 0; --left) {
      check_descriptor();
      GridDescriptor found;
      GridBase::Ptr grid = found.read(in_);
      const std::string name = GridDescriptor::nameAsString(found.uniqueName());
      if (wanted.empty() ? is_readable(*grid) : wanted == name || wanted == found.gridName()) {
        fill(grid, found);
        return grid;
      }
      names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", name);
      pass(grid, found);
    }
    if (names.empty()) fail(path_, "the file holds no grid");
    if (wanted.empty()) fail(path_, fmt::format("the file holds no grid of numbers or vectors; there is {}", names));
    fail(path_, fmt::format("the file holds no grid \"{}\"; there is {}", wanted, names));
  }

 private:
  static bool is_readable(const GridBase& grid) {
    return grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::Vec3SGrid>() ||
           grid.isType<openvdb::DoubleGrid>() || grid.isType<openvdb::Int32Grid>();
  }

  void fill(const GridBase::Ptr& grid, const GridDescriptor& found) {
    if (!is_readable(*grid))
      fail(path_, fmt::format("the grid \"{}\" holds neither numbers nor vectors of three floats; no others are read",
                              found.gridName()));
    if (inputHasGridOffsets()) found.seekToGrid(in_);
    check_grid_metadata();
    readGrid(grid, found, in_);
    if (!found.isInstance()) return;
    if (found.instanceParentName() == found.uniqueName()) fail(path_, "the file is damaged: a grid is its own copy");
    grid->setTree(OpenVdbFile(path_).read(GridDescriptor::nameAsString(found.instanceParentName()))->baseTreePtr());
  }

  void pass(const GridBase::Ptr& grid, const GridDescriptor& found) {
    if (!inputHasGridOffsets()) {
      check_grid_metadata();
      return readGrid(grid, found, in_);
    }
    if (found.getEndPos() < in_.tellg()) fail(path_, "the file is damaged: a grid ends before it begins");
    found.seekToEnd(in_);
  }

  void check_format() {
    in_.seekg(sizeof(kMagic));
    if (const std::uint32_t format = take_size(); format < kOldestFormat || format > openvdb::OPENVDB_FILE_VERSION)
      fail(path_, fmt::format("the file is of OpenVDB's format {}, and those from {} to {} are read", format,
                              kOldestFormat, openvdb::OPENVDB_FILE_VERSION));
    in_.seekg(0);
  }

  /// Looks at the names that the next descriptor begins with, and goes back.
  void check_descriptor() {
    const auto place = in_.tellg();
    for (int name = 0; name < 3; ++name) take_text();
    in_.seekg(place);
  }

  void check_grid_metadata() {
    const auto place = in_.tellg();
    if (fileVersion() >= openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION) take_size();  // how it is compressed
    check_metadata();
    in_.seekg(place);
  }

  /// Looks at the sizes in the metadata that come next, and goes back: OpenVDB writes as much as a size says into a
  /// place as large as the type.
  void check_metadata() {
    using openvdb::Metadata;
    const auto place = in_.tellg();
    for (std::uint32_t left = take_size(); left > 0; --left) {
      take_text();
      const std::string type = take_text();
      const std::uint32_t size = take_size();
      const bool is_fixed = Metadata::isRegisteredType(type) && Metadata::createMetadata(type)->size() > 0;
      if (is_fixed && Metadata::createMetadata(type)->size() != size)
        fail(path_, fmt::format("the file is damaged: it says that a {} takes {} bytes", type, size));
      take_text_of(size);
    }
    in_.seekg(place);
  }

  std::uint32_t take_size() {
    std::uint32_t size = 0;
    in_.read(reinterpret_cast<char*>(&size), sizeof(size));
    return size;
  }
  std::string take_text() { return take_text_of(take_size()); }
  std::string take_text_of(std::uint32_t size) {
    if (size > size_) fail(path_, "the file ends in the middle of a grid");
    std::string text(size, '\0');
    in_.read(text.data(), size);
    return text;
  }

  const std::filesystem::path& path_;
  std::ifstream in_;
  std::uint64_t size_;
};

template <typename Grid>
NvdbBytes packed(const Grid& grid) {
  const auto handle = nanovdb::openToNanoVDB(grid, nanovdb::StatsMode::Disable, nanovdb::ChecksumMode::Disable);
  NvdbBytes bytes(handle.size());
  std::memcpy(bytes.bytes().data(), handle.data(), handle.size());
  return bytes;
}

NvdbBytes packed(const GridBase::Ptr& grid) {
  if (const auto vectors = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid)) return packed(*vectors);
  if (const auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid)) return packed(openvdb::FloatGrid(*doubles));
  if (const auto integers = openvdb::gridPtrCast<openvdb::Int32Grid>(grid))
    return packed(openvdb::FloatGrid(*integers));
  return packed(*openvdb::gridPtrCast<openvdb::FloatGrid>(grid));
}

}  // namespace

bool is_openvdb_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) fail(file, "the file cannot be opened");
  std::uint64_t magic = 0;
  in.read(reinterpret_cast<char*>(&magic), sizeof(magic));
  return magic == kMagic;
}

NvdbBytes read_openvdb_file(const std::filesystem::path& file, const std::string& grid) {
  openvdb::initialize();
  try {
    const GridBase::Ptr found = OpenVdbFile(file).read(grid);
    if (!found->transform().isLinear())
      fail(file, fmt::format("the grid \"{}\" narrows with distance, and only straight ones are read: resample it into "
                             "one with a linear transform",
                             found->getName()));
    return packed(found);
  } catch (const std::ios_base::failure&) {
    fail(file, "the file ends in the middle of a grid");
  } catch (const openvdb::Exception& error) {
    fail(file, fmt::format("the file is damaged, or OpenVDB {} cannot read it: {}", openvdb::getLibraryVersionString(),
                           error.what()));
  } catch (const std::bad_alloc&) {
    fail(file, "the file is damaged, or its grid is larger than memory");
  }
}

}  // namespace etendue
