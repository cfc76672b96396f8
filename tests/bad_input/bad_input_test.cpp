// Damaged and nonsensical scene files and camera settings: each must give the message that stands beside it, in bounded
// time and memory.
//
// corpus/NAME.dae, NAME.xml or NAME.txt is read; corpus/NAME.expected says how that ends. Its first line is "error"
// (reading fails), "warning" (it succeeds, with something to say) or "ok" (it succeeds in silence); each further line
// must occur in the messages.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "camera/settings_file.h"
#include "formats/formats.h"

namespace etendue {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> lines_of(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// How reading a file ended: "error", "warning" or "ok", and all messages.
struct Outcome {
  std::string verdict, messages;
};

Outcome read(const fs::path& path) {
  Diagnostics diagnostics;
  Outcome outcome{"ok", {}};
  try {
    if (path.extension() == ".txt")
      read_camera_settings(path, 800, 600);
    else
      read_scene(path, diagnostics);
  } catch (const Error& error) {
    EXPECT_EQ(error.failure(), Failure::input);
    outcome = {"error", error.what()};
  }
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    outcome.messages += "\n" + diagnostics.format(diagnostic);
    if (diagnostic.severity == Severity::warning && outcome.verdict == "ok") outcome.verdict = "warning";
  }
  return outcome;
}

/// Every message is for a person: it names the file.
void expect_outcome(const fs::path& path, std::string_view verdict, const std::vector<std::string>& parts) {
  SCOPED_TRACE(path.filename().string());
  const Outcome outcome = read(path);
  EXPECT_EQ(outcome.verdict, verdict) << outcome.messages;
  for (const std::string& part : parts)
    EXPECT_NE(outcome.messages.find(part), std::string::npos) << "missing: " << part << "\nin: " << outcome.messages;
  if (verdict != "ok") {
    EXPECT_NE(outcome.messages.find(path.filename().string()), std::string::npos) << outcome.messages;
  }
}

/// All files that are to be read.
std::vector<fs::path> corpus() {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(BAD_INPUT_CORPUS))
    if (entry.path().extension() != ".expected") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

fs::path expectation(fs::path file) {
  return file.replace_extension(".expected");
}

TEST(BadInput, CorpusIsWhole) {
  const std::vector<fs::path> files = corpus();
  EXPECT_GE(files.size(), 40u);
  for (const fs::path& file : files) EXPECT_TRUE(fs::exists(expectation(file))) << file;
}

class BadInputFile : public ::testing::TestWithParam<fs::path> {};

TEST_P(BadInputFile, GivesTheExpectedMessage) {
  std::vector<std::string> expected = lines_of(expectation(GetParam()));
  ASSERT_FALSE(expected.empty());
  const std::string verdict = expected.front();
  expected.erase(expected.begin());
  expect_outcome(GetParam(), verdict, expected);
}

INSTANTIATE_TEST_SUITE_P(Corpus, BadInputFile, ::testing::ValuesIn(corpus()), [](const auto& parameter) {
  std::string name = parameter.param.stem().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

/// Files too large to be kept are made by the test.
class MadeInput : public ::testing::Test {
 protected:
  MadeInput()
      : path_(fs::temp_directory_path() / fmt::format("etendue-{}-{}.dae",
                                                      ::testing::UnitTest::GetInstance()->current_test_info()->name(),
                                                      ::getpid())) {}
  ~MadeInput() override { fs::remove(path_); }

  void expect(const std::string& content, std::string_view verdict, const std::vector<std::string>& parts) {
    std::ofstream(path_, std::ios::binary) << content;
    const auto start = std::chrono::steady_clock::now();
    expect_outcome(path_, verdict, parts);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
  }

  static std::string repeated(std::string_view text, int times) {
    std::string result;
    result.reserve(text.size() * static_cast<std::size_t>(times));
    for (int i = 0; i < times; ++i) result += text;
    return result;
  }

  static std::string document(const std::string& libraries, const std::string& nodes) {
    return "<COLLADA version=\"1.4.1\">" + libraries + "<library_visual_scenes><visual_scene id=\"s\">" + nodes +
           "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
  }

  fs::path path_;
};

TEST_F(MadeInput, NodesNestedDeeply) {
  constexpr int kDepth = 100000;
  expect(document("", repeated("<node>", kDepth) + repeated("</node>", kDepth)), "error",
         {"nested more than 200 deep"});
}

TEST_F(MadeInput, OtherElementsNestedDeeply) {
  constexpr int kDepth = 300000;
  expect(document(repeated("<extra>", kDepth) + repeated("</extra>", kDepth), ""), "ok", {});
}

TEST_F(MadeInput, NestedAndTruncated) {
  expect("<COLLADA>" + repeated("<node>", 300000), "error", {"truncated"});
}

TEST_F(MadeInput, ErrorsWithoutEndAreCutShort) {
  expect(document("", repeated("<node><instance_geometry url=\"#none\"/></node>", 50000)), "error",
         {"reading stopped here: repair these first"});
}

TEST_F(MadeInput, WarningsWithoutEndAreCutShort) {
  std::string nodes;
  for (int i = 0; i < 20000; ++i) nodes += fmt::format("<node><instance_light url=\"#l{}\"/></node>", i);
  expect(document("", nodes), "warning", {"further warnings are not shown (19950 times"});
}

TEST_F(MadeInput, LongNamesAreCutInMessages) {
  const std::string name(3000000, 'x');
  expect(document("<library_geometries><geometry id=\"" + name + "y\"/></library_geometries>",
                  "<node><instance_geometry url=\"#" + name + "\"/></node>"),
         "error", {"xxx…\""});
}

TEST_F(MadeInput, PolygonWithMoreCornersThanAreCut) {
  std::string positions, indices;
  constexpr int kCorners = 200000;  // a star: not convex
  for (int i = 0; i < kCorners; ++i) {
    const double angle = i * 6.283185307179586 / kCorners, radius = i % 2 == 0 ? 1 : 0.5;
    positions += fmt::format("{} {} 0 ", radius * std::cos(angle), radius * std::sin(angle));
    indices += fmt::format("{} ", i);
  }
  expect(
      document(
          fmt::format(
              "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" count=\"{0}\">{1}"
              "</float_array><technique_common><accessor source=\"#a\" count=\"{2}\" stride=\"3\"/></technique_common>"
              "</source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><polylist "
              "count=\"1\">"
              "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><vcount>{2}</vcount><p>{3}</p></polylist></mesh>"
              "</geometry></library_geometries>",
              3 * kCorners, positions, kCorners, indices),
          "<node><instance_geometry url=\"#g\"/></node>"),
      "warning", {"has too many corners"});
}

TEST_F(MadeInput, ManyPrimitivesShareOneLargeSource) {
  constexpr int kPositions = 100000, kPrimitives = 20000;
  expect(
      document(
          fmt::format(
              "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" count=\"{0}\">{1}"
              "</float_array><technique_common><accessor source=\"#a\" count=\"{2}\" stride=\"3\"/></technique_common>"
              "</source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>{3}</mesh>"
              "</geometry></library_geometries>",
              3 * kPositions, repeated("0 0 1 0 1 0 1 0 0 ", kPositions / 3) + "0 0 0", kPositions,
              repeated("<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 "
                       "2</p></triangles>",
                       kPrimitives)),
          "<node><instance_geometry url=\"#g\"/></node>"),
      "warning", {"no material is bound to a part of this geometry; grey (0.5) is used (20000 times"});
}

}  // namespace
}  // namespace etendue
