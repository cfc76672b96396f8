#include "formats/report.h"

namespace etendue {
namespace {
constexpr std::size_t kMostErrors = 20;
constexpr std::size_t kMostWarnings = 50;
constexpr std::size_t kMostInfos = 50;
}  // namespace

void Report::error(const Problem& problem) {
  diagnostics_.error(problem.what(), problem.where());
  if (++errors_ < kMostErrors) return;
  diagnostics_.error("reading stopped here: repair these first, there may be more");
  diagnostics_.throw_if_errors();
}

void Report::warning(const std::string& message, SourceLocation where) {
  if (++warnings_ <= kMostWarnings)
    diagnostics_.repaired(message, where);
  else
    diagnostics_.repaired("further warnings are not shown", where);
}

void Report::repaired(std::string_view message, SourceLocation where, std::uint64_t times) {
  diagnostics_.repaired(message, where, times);
}

void Report::info_once(const std::string& message, SourceLocation where) {
  if (told_.size() < kMostInfos && told_.insert(message).second) diagnostics_.info(message, where);
}

}  // namespace etendue
