#include <fmt/format.h>

#include <csignal>
#include <exception>
#include <new>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/log.h"
#include "commands.h"
#include "options.h"
#include "terminal.h"

namespace etendue {

int run(const PrintText& request) {
  write_result(request.text);
  return 0;
}

namespace {

int exit_code(Failure failure) {
  switch (failure) {
    case Failure::usage:
      return 2;
    case Failure::input:
      return 3;
    case Failure::output:
      return 4;
    case Failure::internal:
      break;
  }
  return 1;
}

/// What readers collect says "error:" behind the place in the file; everything else gets it in front.
std::string with_severity(std::string_view message) {
  const bool has_one = message.substr(0, message.find('\n')).find("error: ") != std::string_view::npos;
  return has_one ? std::string(message) : fmt::format("error: {}", message);
}

int run_program(int argc, const char* const* argv) {
  try {
    const CommandLine line = parse_command_line(argc, argv);
    set_log_level(line.log_level);
    return std::visit([](const auto& command) { return run(command); }, line.command);
  } catch (const Error& error) {
    log_error(with_severity(error.what()));
    return exit_code(error.failure());
  } catch (const std::bad_alloc&) {
    log_error("error: there is not enough memory for this; a smaller picture or scene needs less");
    return exit_code(Failure::internal);
  } catch (const std::exception& error) {
    log_error(fmt::format("internal error: {}; please report it with the command line", error.what()));
    return exit_code(Failure::internal);
  }
}

}  // namespace
}  // namespace etendue

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // whoever reads our output may leave
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow further is an error with a message
  return etendue::run_program(argc, argv);
}
