#include "formats/mitsuba/writer/side_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <span>

#include "base/error.h"
#include "base/output_file.h"
#include "formats/mitsuba/writer/elements.h"
#include "image/io.h"

namespace etendue::mitsuba {
namespace {

namespace fs = std::filesystem;

/// One name for a file, however it is spelled and through whatever links.
fs::path resolved(const fs::path& file) {
  std::error_code failure;
  fs::path canonical = fs::weakly_canonical(fs::absolute(file), failure);
  return failure ? file : canonical;
}

[[noreturn]] void fail(const fs::path& path, const std::error_code& reason) {
  throw Error(Failure::output, fmt::format("cannot write {}: {}; check that the folder may be written to, or choose another place",
                                           path.string(), reason.message()));
}

}  // namespace

SideFiles::SideFiles(const fs::path& scene_file)
    : scene_file_(scene_file), folder_(scene_file.parent_path() / (scene_file.stem().string() + "_files")) {
  check_file_writable(scene_file);
  temporary_ = folder_;
  temporary_.replace_filename(fmt::format(".{}.partial-{}", folder_.filename().string(), ::getpid()));
  std::error_code failure;
  const bool is_ours = fs::is_directory(folder_, failure) && fs::exists(scene_file, failure);
  if (fs::exists(folder_, failure) && !is_ours)
    throw Error(Failure::output, fmt::format("the files of {} would go into {}, which is there already and may belong to something "
                                             "else; remove it or choose another name",
                                             scene_file.string(), folder_.string()));
}

SideFiles::~SideFiles() {
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

fs::path SideFiles::new_file(std::string_view stem, std::string_view extension) {
  std::error_code failure;
  fs::create_directory(temporary_, failure);
  if (failure) fail(temporary_, failure);
  std::string name;
  Ids similar;  // counts up to a name that is free
  do name = similar.unique(stem, "file") + std::string(extension);
  while (!names_.insert(name).second);
  return temporary_ / name;
}

std::string SideFiles::add(std::string_view stem, std::string_view extension, std::string_view bytes) {
  const fs::path file = new_file(stem, extension);
  write_whole_file(file, std::as_bytes(std::span(bytes)));
  return (folder_.filename() / file.filename()).string();
}

std::string SideFiles::add_picture(std::string_view stem, const Image& image) {
  const fs::path file = new_file(stem, ".exr");
  write_picture(file, {image, {}, {}});
  return (folder_.filename() / file.filename()).string();
}

std::string SideFiles::elsewhere(const fs::path& file) {
  const fs::path whole = resolved(file);
  referred_to_.insert(whole);
  const fs::path relative = whole.lexically_relative(resolved(scene_file_).parent_path());
  return relative.empty() ? whole.string() : relative.string();
}

void SideFiles::commit(const std::string& scene_text) {
  for (const std::string& name : names_)
    if (referred_to_.contains(resolved(folder_ / name)))
      throw Error(Failure::usage, fmt::format("{} would be overwritten, but the scene needs it; choose another name",
                                              (folder_ / name).string()));
  std::error_code failure;
  if (!names_.empty()) fs::create_directory(folder_, failure);
  if (failure) fail(folder_, failure);
  for (const std::string& name : names_) {
    fs::rename(temporary_ / name, folder_ / name, failure);
    if (failure) fail(folder_ / name, failure);
  }
  write_whole_file(scene_file_, std::as_bytes(std::span(scene_text)));
}

}  // namespace etendue::mitsuba
