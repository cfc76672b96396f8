#include "base/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "base/error.h"

namespace etendue {
namespace {

constexpr std::size_t kExcerptWidth = 100;

/// Line `line` (from 1) of the file, or nothing if the file has no such line any more.
std::string read_line(const std::filesystem::path& path, std::uint32_t line) {
  std::ifstream file(path);
  std::string text;
  for (std::uint32_t i = 0; i < line; ++i)
    if (!std::getline(file, text)) return {};
  return text;
}

/// The source line, cut to a window around the column, and a caret below it. Control characters become spaces.
std::string excerpt(const std::filesystem::path& path, SourceLocation where) {
  std::string text = read_line(path, where.line);
  if (text.empty()) return {};
  const std::size_t column = where.column > 0 ? where.column - 1 : 0;
  const std::size_t begin = column > kExcerptWidth * 3 / 4 ? column - kExcerptWidth / 2 : 0;
  if (begin >= text.size()) return {};
  text = text.substr(begin, kExcerptWidth);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  std::string out = "\n    " + text;
  if (where.column > 0) out += "\n    " + std::string(column - begin, ' ') + "^";
  return out;
}

}  // namespace

std::uint32_t Diagnostics::add_file(const std::filesystem::path& path) {
  files_.push_back(path);
  return static_cast<std::uint32_t>(files_.size() - 1);
}

void Diagnostics::add(Severity severity, std::string message, SourceLocation where) {
  if (severity == Severity::error) ++errors_;
  diagnostics_.push_back({severity, std::move(message), where, 1});
}

void Diagnostics::info(std::string message, SourceLocation where) {
  add(Severity::info, std::move(message), where);
}
void Diagnostics::warning(std::string message, SourceLocation where) {
  add(Severity::warning, std::move(message), where);
}
void Diagnostics::error(std::string message, SourceLocation where) {
  add(Severity::error, std::move(message), where);
}

void Diagnostics::repaired(std::string_view message, SourceLocation where, std::uint64_t times) {
  if (times == 0) return;
  for (Diagnostic& d : diagnostics_)
    if (d.severity == Severity::warning && d.message == message) {
      d.count += times;
      return;
    }
  diagnostics_.push_back({Severity::warning, std::string(message), where, times});
}

std::string Diagnostics::format(const Diagnostic& diagnostic) const {
  static constexpr std::string_view kNames[] = {"info", "warning", "error"};
  std::string out;
  const SourceLocation& where = diagnostic.where;
  const bool has_file = where.known() && where.file < files_.size();
  if (has_file) {
    out += fmt::format("{}:{}:", files_[where.file].string(), where.line);
    if (where.column > 0) out += fmt::format("{}:", where.column);
    out += ' ';
  }
  out += fmt::format("{}: {}", kNames[static_cast<int>(diagnostic.severity)], diagnostic.message);
  if (diagnostic.count > 1) out += fmt::format(" ({} times, this is the first)", diagnostic.count);
  if (has_file && diagnostic.severity != Severity::info) out += excerpt(files_[where.file], where);
  return out;
}

void Diagnostics::throw_if_errors() const {
  if (!has_errors()) return;
  std::string text;
  for (const Diagnostic& d : diagnostics_)
    if (d.severity == Severity::error) text += (text.empty() ? "" : "\n") + format(d);
  throw Error(Failure::input, text);
}

}  // namespace etendue
