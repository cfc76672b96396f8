#include "formats/volume_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "base/error.h"

namespace etendue {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string little_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}
std::string little_endian(float value) {
  return little_endian(std::bit_cast<std::uint32_t>(value));
}

std::string file(std::array<std::uint32_t, 3> size, std::uint32_t channels, const std::vector<float>& values) {
  std::string bytes = "VOL\x03" + little_endian(1u);
  for (const std::uint32_t cells : size) bytes += little_endian(cells);
  bytes += little_endian(channels);
  for (const float coordinate : {-1.0f, -2.0f, -3.0f, 1.0f, 2.0f, 3.0f}) bytes += little_endian(coordinate);
  for (const float value : values) bytes += little_endian(value);
  return bytes;
}

VolumeFile parse(const std::string& bytes) {
  Diagnostics diagnostics;
  return parse_volume_file(bytes, "smoke.vol", diagnostics);
}

TEST(VolumeFile, IsRead) {
  const VolumeFile volume = parse(file({3, 2, 1}, 1, {1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(volume.grid.size, (std::array<int, 3>{3, 2, 1}));
  EXPECT_EQ(volume.grid.channels, 1);
  EXPECT_EQ(volume.grid.values, (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(volume.box_min, (std::array<float, 3>{-1, -2, -3}));
  EXPECT_EQ(volume.box_max, (std::array<float, 3>{1, 2, 3}));
  EXPECT_EQ(parse(file({1, 1, 2}, 3, {1, 2, 3, 4, 5, 6})).grid.channels, 3);
}

TEST(VolumeFile, ValuesThatAreNotFiniteBecomeZero) {
  Diagnostics diagnostics;
  const std::string bytes = file({2, 1, 1}, 1, {std::numeric_limits<float>::quiet_NaN(), 5});
  EXPECT_EQ(parse_volume_file(bytes, "smoke.vol", diagnostics).grid.values, (std::vector<float>{0, 5}));
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_THAT(diagnostics.all()[0].message, HasSubstr("smoke.vol: a value of the grid is not finite"));
}

TEST(VolumeFile, DamagedFilesAreRejected) {
  const std::string good = file({2, 1, 1}, 1, {1, 2});
  EXPECT_THAT([&] { parse("NOT" + good.substr(3)); }, ThrowsMessage<Error>(HasSubstr("does not begin with \"VOL\"")));
  EXPECT_THAT([&] { parse("VOL\x02" + good.substr(4)); }, ThrowsMessage<Error>(HasSubstr("version 2")));
  EXPECT_THAT([&] { parse(good.substr(0, 30)); }, ThrowsMessage<Error>(HasSubstr("not complete")));
  EXPECT_THAT([&] { parse(good.substr(0, good.size() - 1)); }, ThrowsMessage<Error>(HasSubstr("only 7 bytes follow")));
  EXPECT_THAT([&] { parse(file({2, 0, 1}, 1, {1, 2})); }, ThrowsMessage<Error>(HasSubstr("0 cells wide")));
  EXPECT_THAT([&] { parse(file({2, 1, 1}, 2, {1, 2, 3, 4})); }, ThrowsMessage<Error>(HasSubstr("2 channels")));
}

TEST(VolumeFile, LyingSizesAreRejectedBeforeAllocation) {
  EXPECT_THAT(
      [] {
        parse(file({2147483647, 2147483647, 2147483647}, 3, {1}));
      },
      ThrowsMessage<Error>(HasSubstr("only 4 bytes follow")));
  EXPECT_THAT([] { parse(file({0xffffffff, 1, 1}, 1, {1})); }, ThrowsMessage<Error>(HasSubstr("-1 cells wide")));
}

}  // namespace
}  // namespace etendue
