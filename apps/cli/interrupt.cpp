#include "interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

namespace etendue {
namespace {

std::atomic<bool> asked_to_stop = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch it");

extern "C" void on_interrupt(int) {
  if (asked_to_stop.exchange(true)) ::_exit(kInterruptedExitCode);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

bool interrupted() {
  return asked_to_stop;
}

}  // namespace etendue
