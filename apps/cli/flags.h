#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// The kinds of flags the commands have: each turns the user's words into a value, or ends with Error(Failure::usage)
/// that names the flag, what it takes and what stood there. Given twice, the later one counts.
namespace etendue::flags {

/// A flag with exactly `metavars.size()` words; `set` gets them. `names` as CLI11 takes them, the long one last.
CLI::Option* add(CLI::App& app, const std::string& names, std::vector<std::string> metavars, const std::string& help,
                 std::function<void(std::span<const std::string>)> set);

/// Values a number may have, both ends included.
template <typename T>
struct Range {
  T min, max;
};
template <typename T>
Range(T, T) -> Range<T>;

/// The number that `word` is, all of it; `flag` is how the message names it.
template <typename T>
T parse_number(std::string_view flag, std::string_view word, Range<T> range);

/// A relative error: 0.02 or 2%.
template <typename T>
T parse_share(std::string_view flag, std::string_view word, Range<T> range);

/// A span of time such as 90, 90s, 2m, 1h30m, 1.5h or 500ms, in seconds, above 0.
double parse_duration(std::string_view flag, std::string_view word);

/// An amount of memory such as 512M or 1.5G (of 1024s), in bytes; from 1M.
std::uint64_t parse_memory(std::string_view flag, std::string_view word);

/// Throws "FLAG needs one of …, not "WORD"; did you mean …?".
[[noreturn]] void reject_choice(std::string_view flag, std::string_view word,
                                std::span<const std::string_view> choices);

/// The long name in "-s,--spp".
std::string long_name(const std::string& names);

/// -D NAME=VALUE, any number of times.
CLI::Option* definitions(CLI::App& app, std::map<std::string, std::string>& target, const std::string& help);

/// Target is T or std::optional<T>.
template <typename T, typename Target>
CLI::Option* number(CLI::App& app, const std::string& names, Target& target, Range<T> range, const std::string& metavar,
                    const std::string& help) {
  return add(app, names, {metavar}, help, [&target, range, flag = long_name(names)](auto words) {
    target = parse_number<T>(flag, words[0], range);
  });
}

/// Target is an enum or a std::optional of one.
template <typename T, typename Target>
CLI::Option* choice(CLI::App& app, const std::string& names, Target& target,
                    std::vector<std::pair<std::string_view, T>> choices, const std::string& help) {
  std::string metavar;
  for (const auto& [name, value] : choices) metavar += (metavar.empty() ? "" : "|") + std::string(name);
  return add(app, names, {metavar}, help, [&target, choices, flag = long_name(names)](auto words) {
    std::vector<std::string_view> all;
    for (const auto& [name, value] : choices) {
      if (name == words[0]) {
        target = value;
        return;
      }
      all.push_back(name);
    }
    reject_choice(flag, words[0], all);
  });
}

/// Target is a path or a std::optional of one. An empty word is no path.
template <typename Target>
CLI::Option* file(CLI::App& app, const std::string& names, Target& target, const std::string& help);

}  // namespace etendue::flags
