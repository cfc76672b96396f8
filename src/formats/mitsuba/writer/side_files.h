#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mitsuba/writer/elements.h"
#include "image/image.h"

namespace etendue::mitsuba {

/// The files that a scene NAME.xml needs beside it, in the folder NAME_files. They are written under a temporary name
/// and stand there when the scene does; if it comes to nothing, nothing of them stays.
class SideFiles {
 public:
  /// Thrown where the next file would be written if `stopped` says so.
  struct Stopped {};

  /// `stopped` may be null. Throws Error(Failure::output) if NAME_files is something else than the folder of an older
  /// NAME.xml.
  SideFiles(const std::filesystem::path& scene_file, bool (*stopped)());
  ~SideFiles();
  SideFiles(const SideFiles&) = delete;
  SideFiles& operator=(const SideFiles&) = delete;

  /// Writes STEM.EXTENSION, or a name like it, and returns how the scene names it. Throws Error(Failure::output).
  std::string add(std::string_view stem, std::string_view extension, std::string_view bytes);
  /// The same for a picture, as .exr.
  std::string add_picture(std::string_view stem, const Image& image);
  /// How the scene names a file that lies elsewhere and stays there.
  std::string elsewhere(const std::filesystem::path& file);

  /// Puts the files into their folder, and then the scene. Throws Error(Failure::output), Error(Failure::usage) if one
  /// of them would take the place of a file that the scene refers to.
  void commit(const std::string& scene_text);

 private:
  void stop_if_asked() const;
  std::filesystem::path new_file(std::string_view stem, std::string_view extension);

  std::filesystem::path scene_file_, folder_, temporary_;
  bool (*stopped_)();
  Ids stems_;
  std::vector<std::string> names_;
  std::set<std::filesystem::path> referred_to_;
};

}  // namespace etendue::mitsuba
