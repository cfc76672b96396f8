#include "base/diagnostics.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "base/text.h"

namespace etendue {
namespace {

TEST(Diagnostics, ShowsPlaceExcerptAndCaret) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "etendue_diagnostics_test.txt";
  std::ofstream(path) << "first\nsecond line\n";
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.add_file(path);
  diagnostics.error("wrong word", {file, 2, 8});
  EXPECT_EQ(diagnostics.format(diagnostics.all()[0]),
            path.string() + ":2:8: error: wrong word\n    second line\n           ^");
  EXPECT_THROW(diagnostics.throw_if_errors(), Error);
  std::filesystem::remove(path);
}

TEST(Diagnostics, CountsTheSameRepair) {
  Diagnostics diagnostics;
  diagnostics.repaired("zero normal replaced");
  diagnostics.repaired("zero normal replaced", {}, 4);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].count, 5u);
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_NO_THROW(diagnostics.throw_if_errors());
}

TEST(Text, NearestWordNeedsToBeNear) {
  const std::string_view words[] = {"spp", "seed", "resolution", "max-depth"};
  EXPECT_EQ(nearest_word("resolutoin", words), "resolution");
  EXPECT_EQ(nearest_word("maxdepth", words), "max-depth");
  EXPECT_EQ(nearest_word("banana", words), std::nullopt);
  EXPECT_EQ(edit_distance("ab", "ba"), 1u);
}

}  // namespace
}  // namespace etendue
