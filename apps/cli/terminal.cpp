#include "terminal.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "base/error.h"

namespace etendue {

std::optional<TerminalSize> terminal_size() {
  const char* const kind = std::getenv("TERM");
  if (!::isatty(STDERR_FILENO) || (kind && std::string_view(kind) == "dumb")) return std::nullopt;
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0)
    return TerminalSize{80, 24};
  return TerminalSize{size.ws_col, size.ws_row};
}

void write_terminal(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void write_result(std::string_view text) {
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (written || errno == EPIPE) return;
  throw Error(Failure::output, fmt::format("cannot write to standard output: {}",
                                           std::error_code(errno, std::generic_category()).message()));
}

std::string counted(std::string_view number, std::string_view noun) {
  return fmt::format("{} {}{}", number, noun, number == "1" ? "" : "s");
}

std::string counted(std::size_t number, std::string_view noun) {
  return counted(std::to_string(number), noun);
}

std::string with_magnitude(double value) {
  static constexpr std::pair<double, const char*> kMagnitudes[] = {{1e12, "T"}, {1e9, "G"}, {1e6, "M"}, {1e3, "k"}};
  for (const auto& [size, name] : kMagnitudes)
    if (value >= size) return fmt::format("{:.3g} {}", value / size, name);
  return fmt::format("{:.3g} ", value);
}

std::string as_duration(double seconds) {
  if (seconds < 10) return fmt::format("{:.2f} s", seconds);
  if (seconds < 60) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long long>(std::min(seconds, 1e15));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace etendue
