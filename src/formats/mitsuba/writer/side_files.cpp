#include "formats/mitsuba/writer/side_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <span>

#include "base/error.h"
#include "base/output_file.h"
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
  throw Error(Failure::output,
              fmt::format("cannot write {}: {}; check that the folder may be written to, or choose another place",
                          path.string(), reason.message()));
}

void make_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directory(folder, failure);
  if (failure) fail(folder, failure);
}

void move(const fs::path& from, const fs::path& to) {
  std::error_code failure;
  fs::rename(from, to, failure);
  if (failure) fail(to, failure);
}

}  // namespace

SideFiles::SideFiles(const fs::path& scene_file, bool (*stopped)())
    : scene_file_(scene_file),
      folder_(scene_file.parent_path() / (scene_file.stem().string() + "_files")),
      stopped_(stopped) {
  check_file_writable(scene_file);
  temporary_ = folder_;
  temporary_.replace_filename(fmt::format(".{}.partial-{}", folder_.filename().string(), ::getpid()));
  std::error_code failure;
  const bool is_ours = fs::is_directory(folder_, failure) && fs::exists(scene_file, failure);
  if (fs::exists(folder_, failure) && !is_ours)
    throw Error(Failure::output,
                fmt::format("the files of {} would go into {}, which is there already and may belong to something "
                            "else; remove it or choose another name",
                            scene_file.string(), folder_.string()));
}

SideFiles::~SideFiles() {
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

void SideFiles::stop_if_asked() const {
  if (stopped_ != nullptr && stopped_()) throw Stopped{};
}

fs::path SideFiles::new_file(std::string_view stem, std::string_view extension) {
  stop_if_asked();
  make_folder(temporary_);
  return temporary_ / names_.emplace_back(stems_.unique(stem, "file") + std::string(extension));
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
  const fs::path relative = whole.lexically_relative(resolved(fs::absolute(scene_file_).parent_path()));
  return relative.empty() ? whole.string() : relative.string();
}

void SideFiles::commit(const std::string& scene_text) {
  stop_if_asked();
  for (const std::string& name : names_)
    if (referred_to_.contains(resolved(folder_ / name)))
      throw Error(Failure::usage, fmt::format("{} would be overwritten, but the scene needs it; choose another name",
                                              (folder_ / name).string()));
  make_folder(temporary_);
  write_whole_file(temporary_ / scene_file_.filename(), std::as_bytes(std::span(scene_text)));
  if (!names_.empty()) make_folder(folder_);
  for (const std::string& name : names_) move(temporary_ / name, folder_ / name);
  move(temporary_ / scene_file_.filename(), scene_file_);
}

}  // namespace etendue::mitsuba
