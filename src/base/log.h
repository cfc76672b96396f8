#pragma once

#include <string_view>

namespace etendue {

/// Which messages reach standard error.
enum class LogLevel { quiet /*errors only*/, normal /*info and up*/, verbose };

/// Chooses the level for the whole program; called once, by the program's main.
void set_log_level(LogLevel level);

void log_debug(std::string_view message);
void log_info(std::string_view message);
void log_warning(std::string_view message);
void log_error(std::string_view message);

}  // namespace etendue
