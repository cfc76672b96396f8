#include "flags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cstdint>

#include "base/error.h"
#include "base/text.h"

namespace etendue::flags {
namespace {

[[noreturn]] void reject(std::string_view flag, std::string_view needed, std::string_view word) {
  throw Error(Failure::usage, fmt::format("{} needs {}, not \"{}\"", flag, needed, word));
}

template <typename T>
std::optional<T> whole_word_as(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T value{};
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// "1h30m" → 5400; a number alone is of seconds. Each unit once, the larger ones first.
std::optional<double> seconds_in(std::string_view word) {
  static constexpr std::pair<std::string_view, double> kUnits[] = {{"h", 3600}, {"m", 60}, {"s", 1}, {"ms", 0.001}};
  if (const std::optional<double> alone = whole_word_as<double>(word)) return alone;
  double total = 0;
  for (const auto& [unit, seconds] : kUnits) {
    const std::size_t end = std::min(word.find_first_not_of("0123456789."), word.size());
    const std::string_view rest = word.substr(end);
    if (rest.substr(0, std::min(rest.find_first_of("0123456789."), rest.size())) != unit) continue;
    const std::optional<double> value = whole_word_as<double>(word.substr(0, end));
    if (!value) return std::nullopt;
    total += *value * seconds;
    word = rest.substr(unit.size());
  }
  return word.empty() ? std::optional(total) : std::nullopt;
}

template <typename T>
std::string describe(Range<T> range) {
  const char* kind = std::is_integral_v<T> ? "a whole number" : "a number";
  const bool has_min = range.min > std::numeric_limits<T>::lowest(),
             has_max = range.max < std::numeric_limits<T>::max();
  if (has_min && has_max) return fmt::format("{} from {} to {}", kind, range.min, range.max);
  if (has_min) return fmt::format("{} of at least {}", kind, range.min);
  return kind;
}

}  // namespace

CLI::Option* add(CLI::App& app, const std::string& names, std::vector<std::string> metavars, const std::string& help,
                 std::function<void(std::span<const std::string>)> set) {
  const int count = static_cast<int>(metavars.size());
  return app
      .add_option(
          names,
          [set = std::move(set)](const CLI::results_t& words) {
            set(words);
            return true;
          },
          help)
      ->type_name(fmt::format("{}", fmt::join(metavars, " ")))
      ->type_size(count)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

template <typename T>
T parse_number(std::string_view flag, std::string_view word, Range<T> range) {
  const std::optional<T> value = whole_word_as<T>(word);
  if (!value || !(*value >= range.min && *value <= range.max)) reject(flag, describe(range), word);
  return *value;
}
template int parse_number(std::string_view, std::string_view, Range<int>);
template std::uint64_t parse_number(std::string_view, std::string_view, Range<std::uint64_t>);
template float parse_number(std::string_view, std::string_view, Range<float>);
template double parse_number(std::string_view, std::string_view, Range<double>);

template <typename T>
T parse_share(std::string_view flag, std::string_view word, Range<T> range) {
  const bool percent = word.ends_with('%');
  const std::optional<T> number = whole_word_as<T>(percent ? word.substr(0, word.size() - 1) : word);
  const T value = number.value_or(std::numeric_limits<T>::quiet_NaN()) / (percent ? T{100} : T{1});
  if (!(value >= range.min && value <= range.max)) reject(flag, describe(range) + ", such as 0.02 or 2%", word);
  return value;
}
template float parse_share(std::string_view, std::string_view, Range<float>);
template double parse_share(std::string_view, std::string_view, Range<double>);

double parse_duration(std::string_view flag, std::string_view word) {
  const std::optional<double> seconds = seconds_in(word);
  if (!seconds || !(*seconds > 0 && *seconds < 1e9)) reject(flag, "a time such as 90s, 2m or 1h30m", word);
  return *seconds;
}

std::uint64_t parse_memory(std::string_view flag, std::string_view word) {
  static constexpr std::pair<char, double> kUnits[] = {{'K', 0x1p10}, {'M', 0x1p20}, {'G', 0x1p30}, {'T', 0x1p40}};
  std::string_view digits = word;
  double unit = 1;
  for (const auto& [letter, bytes] : kUnits)
    if (word.ends_with(letter)) digits = word.substr(0, word.size() - 1), unit = bytes;
  const double bytes = whole_word_as<double>(digits).value_or(0) * unit;
  if (!(bytes >= 0x1p20 && bytes <= 0x1p50)) reject(flag, "an amount of at least 1M, such as 512M or 2G", word);
  return static_cast<std::uint64_t>(bytes);
}

void reject_choice(std::string_view flag, std::string_view word, std::span<const std::string_view> choices) {
  const auto nearest = nearest_word(word, choices);
  throw Error(Failure::usage, fmt::format("{} needs one of {}, not \"{}\"{}", flag, fmt::join(choices, ", "), word,
                                          nearest ? fmt::format("; did you mean {}?", *nearest) : ""));
}

std::string long_name(const std::string& names) {
  return names.substr(names.rfind(',') + 1);
}

template <typename Target>
CLI::Option* file(CLI::App& app, const std::string& names, Target& target, const std::string& help) {
  return add(app, names, {"FILE"}, help, [&target, flag = long_name(names)](auto words) {
    if (words[0].empty()) reject(flag, "the name of a file", "");
    target = std::filesystem::path(words[0]);
  });
}
template CLI::Option* file(CLI::App&, const std::string&, std::filesystem::path&, const std::string&);
template CLI::Option* file(CLI::App&, const std::string&, std::optional<std::filesystem::path>&, const std::string&);

CLI::Option* definitions(CLI::App& app, std::map<std::string, std::string>& target, const std::string& help) {
  const auto set = [&target](const std::vector<std::string>& words) {
    for (const std::string& word : words) {
      const std::size_t equals = word.find('=');
      if (equals == std::string::npos || equals == 0)
        throw Error(Failure::usage, fmt::format("-D needs NAME=VALUE, not \"{}\"", word));
      target[word.substr(0, equals)] = word.substr(equals + 1);
    }
  };
  return app.add_option_function<std::vector<std::string>>("-D,--define", set, help)
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
}

}  // namespace etendue::flags
