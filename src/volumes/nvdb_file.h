#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace etendue {

/// The bytes of a NanoVDB grid, aligned as it wants them.
class NvdbBytes {
 public:
  explicit NvdbBytes(std::size_t size) : blocks_((size + sizeof(Block) - 1) / sizeof(Block)), size_(size) {}
  std::span<std::byte> bytes() { return {blocks_.front().bytes, size_}; }
  std::span<const std::byte> bytes() const { return {blocks_.front().bytes, size_}; }

 private:
  struct alignas(32) Block {
    std::byte bytes[32];
  };
  std::vector<Block> blocks_;
  std::size_t size_;
};

/// The grid of that name (empty: the first) as it stands in a .nvdb file, unpacked but not looked at. Throws
/// Error(Failure::input).
NvdbBytes read_nvdb_file(const std::filesystem::path& file, const std::string& grid);

}  // namespace etendue
