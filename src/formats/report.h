#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "formats/problem.h"

namespace etendue {

/// Passes messages on to Diagnostics, but not endlessly many: a file that is wrong everywhere is not worth a line each.
class Report {
 public:
  explicit Report(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// Collects an error. After the twentieth, everything collected is thrown as Error(Failure::input).
  void error(const Problem& problem);
  /// A warning with a text of its own; after the fiftieth, the rest is only counted.
  void warning(const std::string& message, SourceLocation where);
  void warning(const Problem& problem) { warning(problem.what(), problem.where()); }
  /// A repair that may be made many times, under one constant message.
  void repaired(std::string_view message, SourceLocation where, std::uint64_t times = 1);
  /// An information that is given the first time only; fifty different ones at most.
  void info_once(const std::string& message, SourceLocation where);
  /// For readers that collect their messages themselves.
  Diagnostics& diagnostics() const { return diagnostics_; }

 private:
  Diagnostics& diagnostics_;
  std::size_t errors_ = 0, warnings_ = 0;
  std::set<std::string> told_;
};

}  // namespace etendue
