#include "interrupt.h"

#include <atomic>
#include <csignal>

namespace etendue {
namespace {

std::atomic<bool> asked_to_stop = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch it");

extern "C" void on_interrupt(int) {
  asked_to_stop = true;
}

}  // namespace

void catch_interrupts() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(number, on_interrupt) == SIG_IGN) std::signal(number, SIG_IGN);
}

bool interrupted() {
  return asked_to_stop;
}

}  // namespace etendue
