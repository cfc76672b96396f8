#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace etendue {

/// A place in a file that was read. `line` and `column` count from 1; 0 means "not known".
struct SourceLocation {
  std::uint32_t file = 0;  ///< index from Diagnostics::add_file
  std::uint32_t line = 0;
  std::uint32_t column = 0;

  bool known() const { return line != 0; }
};

enum class Severity { info, warning, error };

/// One thing worth telling the user.
struct Diagnostic {
  Severity severity = Severity::info;
  std::string message;      ///< what is the case, and the remedy
  SourceLocation where;     ///< the first place
  std::uint64_t count = 1;  ///< how often the same repair was made
};

/// Collects what reading and compiling a scene has to say, so that everything that can be reported in one go is.
/// Not thread-safe: reading is sequential.
class Diagnostics {
 public:
  /// Registers a file so that locations can name it; excerpts are read back from it when a message is formatted.
  std::uint32_t add_file(const std::filesystem::path& path);

  void info(std::string message, SourceLocation where = {});
  void warning(std::string message, SourceLocation where = {});
  void error(std::string message, SourceLocation where = {});

  /// A repair that may happen many times (a zero normal, a degenerate triangle): the same `message` is kept once,
  /// with the place of the first and the count of all.
  void repaired(std::string_view message, SourceLocation where = {}, std::uint64_t times = 1);

  const std::vector<Diagnostic>& all() const { return diagnostics_; }
  bool has_errors() const { return errors_ > 0; }

  /// "file:line:column: warning: message"; warnings and errors are followed by the source line and a caret where the
  /// place is known.
  std::string format(const Diagnostic& diagnostic) const;

  /// Throws Error(Failure::input) with all collected errors, formatted, if there is any.
  void throw_if_errors() const;

 private:
  void add(Severity severity, std::string message, SourceLocation where);

  std::vector<std::filesystem::path> files_;
  std::vector<Diagnostic> diagnostics_;
  std::size_t errors_ = 0;
};

}  // namespace etendue
