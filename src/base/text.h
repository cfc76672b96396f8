#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace etendue {

/// Number of single-character insertions, deletions, substitutions and neighbour swaps that turn `a` into `b`
/// (Damerau 1964, optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`, if one is near enough to be what was meant ("did you mean …?").
std::optional<std::string_view> nearest_word(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace etendue
