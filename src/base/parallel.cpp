#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace etendue {

struct ThreadLimit::Impl {
  tbb::global_control control;
  tbb::task_arena arena;
};

namespace {
tbb::task_arena* current_arena = nullptr;
}

int hardware_threads() { return tbb::info::default_concurrency(); }

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body) {
  const auto run = [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); },
                      tbb::simple_partitioner{});
  };
  if (current_arena != nullptr)
    current_arena->execute(run);
  else
    run();
}

ThreadLimit::ThreadLimit(int threads) {
  const int n = threads > 0 ? threads : hardware_threads();
  impl_ = std::unique_ptr<Impl>(
      new Impl{tbb::global_control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(n)),
               tbb::task_arena(n)});
  current_arena = &impl_->arena;
}

ThreadLimit::~ThreadLimit() { current_arena = nullptr; }

}  // namespace etendue
