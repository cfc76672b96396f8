#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace etendue {

/// Calls `body(begin, end)` for disjoint ranges that cover [0, count), on the machine's threads. Ranges are at most
/// `grain` long. Exceptions of `body` reach the caller. The order of calls is not determined: results must not depend
/// on it.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

/// While it lives, no more than `threads` threads work (0: all of the machine's).
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// How many threads the machine runs at once.
int hardware_threads();

}  // namespace etendue
