#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace etendue {

/// Size of a terminal in characters.
struct TerminalSize {
  int columns, rows;
};

/// The terminal that standard error is; nothing if it is a file or a pipe, or cannot move its cursor (TERM=dumb).
std::optional<TerminalSize> terminal_size();

/// Writes to standard error at once, as it is.
void write_terminal(std::string_view text);

/// Writes a result to standard output. A reader that has gone away is no error; Error(Failure::output) for a full disk.
void write_result(std::string_view text);

/// "1 light", "2 lights", "0.5 samples": the noun in the form that the number, as it is printed, asks for.
std::string counted(std::string_view number, std::string_view noun);
std::string counted(std::size_t number, std::string_view noun);

/// "12.3 M" for 12300000.
std::string with_magnitude(double value);

/// "0.42 s", "12.3 s", "2:05", "1:02:03".
std::string as_duration(double seconds);

}  // namespace etendue
