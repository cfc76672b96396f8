#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#ifdef ETENDUE_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace etendue {

struct ThreadLimit::Impl {
  tbb::global_control control;
  tbb::task_arena arena;
};

namespace {

tbb::task_arena* current_arena = nullptr;

/// Tells ThreadSanitizer what it cannot see inside TBB: all before a loop happens before each call of its body, and
/// each call before all after the loop. Nothing else is said, so that calls that race with each other are found.
class LoopOrder {
 public:
  LoopOrder() { release(start_); }
  ~LoopOrder() { acquire(end_); }
  LoopOrder(const LoopOrder&) = delete;
  LoopOrder& operator=(const LoopOrder&) = delete;

  class Call {
   public:
    explicit Call(LoopOrder& loop) : loop_(loop) { acquire(loop_.start_); }
    ~Call() { release(loop_.end_); }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

   private:
    LoopOrder& loop_;
  };

 private:
#ifdef ETENDUE_THREAD_SANITIZER
  static void acquire(char& mark) {
    __tsan_acquire(&mark);
  }
  static void release(char& mark) {
    __tsan_release(&mark);
  }
#else
  static void acquire(char&) {}
  static void release(char&) {}
#endif

  char start_ = 0, end_ = 0;
};

}  // namespace

int hardware_threads() {
  return tbb::info::default_concurrency();
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body) {
  LoopOrder order;
  const auto call = [&](const tbb::blocked_range<std::size_t>& range) {
    const LoopOrder::Call here(order);
    body(range.begin(), range.end());
  };
  const auto run = [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), call, tbb::simple_partitioner{});
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

ThreadLimit::~ThreadLimit() {
  current_arena = nullptr;
}

}  // namespace etendue
