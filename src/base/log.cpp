#include "base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

namespace etendue {
namespace {

spdlog::logger& logger() {
  static const std::shared_ptr<spdlog::logger> instance = [] {
    const char* const no_color = std::getenv("NO_COLOR");  // no-color.org
    auto made = spdlog::stderr_color_mt(
        "etendue", no_color && *no_color ? spdlog::color_mode::never : spdlog::color_mode::automatic);
    made->set_pattern("%^%v%$");
    return made;
  }();
  return *instance;
}

}  // namespace

void set_log_level(LogLevel level) {
  switch (level) {
    case LogLevel::quiet:
      logger().set_level(spdlog::level::err);
      break;
    case LogLevel::normal:
      logger().set_level(spdlog::level::info);
      break;
    case LogLevel::verbose:
      logger().set_level(spdlog::level::debug);
      break;
  }
}

void log_debug(std::string_view message) {
  logger().debug("{}", message);
}
void log_info(std::string_view message) {
  logger().info("{}", message);
}
void log_warning(std::string_view message) {
  logger().warn("{}", message);
}
void log_error(std::string_view message) {
  logger().error("{}", message);
}

}  // namespace etendue
