#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace etendue {

/// Room for N values that begin to live one by one: where many are kept at hand and few are needed, making them all
/// first would cost more than their use.
template <typename T, int N>
class UninitializedArray {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  UninitializedArray() {}  // NOLINT(modernize-use-equals-default): `= default` would be deleted, as the union's is

  /// Makes value `i` where it stays.
  template <typename... Arguments>
  T& emplace(std::size_t i, Arguments&&... arguments) {
    return *std::construct_at(&values_[i], std::forward<Arguments>(arguments)...);
  }

  T& operator[](std::size_t i) { return values_[i]; }
  const T& operator[](std::size_t i) const { return values_[i]; }

 private:
  union {
    T values_[N];
  };
};

}  // namespace etendue
