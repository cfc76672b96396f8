#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "base/error.h"
#include "formats/mitsuba/mitsuba.h"

/// Small Mitsuba scenes for tests, and what reading them gives.
namespace etendue::mitsuba::test {

/// All messages of a reading, formatted; of the error too if it failed.
struct Reading {
  scene::SceneDescription scene;
  std::string messages;
  bool failed = false;
};

inline Reading read_text(const std::string& text, const std::filesystem::path& path = "test.xml",
                         const Definitions& definitions = {}) {
  Reading result;
  Diagnostics diagnostics;
  try {
    result.scene = mitsuba::read_text(text, path, definitions, diagnostics);
  } catch (const Error&) {
    result.failed = true;
  }
  for (const Diagnostic& diagnostic : diagnostics.all()) result.messages += diagnostics.format(diagnostic) + "\n";
  return result;
}

/// A scene of today's version with this content.
inline Reading read(std::string_view content, std::string_view version = "3.0.0", const Definitions& definitions = {}) {
  return read_text(fmt::format("<scene version=\"{}\">\n{}\n</scene>", version, content), "test.xml", definitions);
}

/// A folder for one test's files, gone when the test is.
class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / fmt::format("etendue-mitsuba-{}", ::getpid())) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path add(const std::filesystem::path& name, std::string_view content) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace etendue::mitsuba::test
