#include "allocation_counter.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace etendue {
namespace {

std::atomic<std::int64_t> held{0}, most_held{0};

}  // namespace

std::int64_t bytes_held() {
  return held;
}

std::int64_t most_bytes_held() {
  return most_held;
}

void forget_most_bytes_held() {
  most_held = held.load();
}

}  // namespace etendue

void* operator new(std::size_t size) {
  void* memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  const std::int64_t now = etendue::held += static_cast<std::int64_t>(malloc_usable_size(memory));
  for (std::int64_t most = etendue::most_held; now > most;)
    if (etendue::most_held.compare_exchange_weak(most, now)) break;
  return memory;
}

void operator delete(void* memory) noexcept {
  etendue::held -= static_cast<std::int64_t>(malloc_usable_size(memory));
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  operator delete(memory);
}
