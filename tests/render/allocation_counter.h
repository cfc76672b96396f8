#pragma once

#include <cstdint>

namespace etendue {

/// Bytes that operator new gave out and has not got back; a program that links allocation_counter.cpp counts them.
std::int64_t bytes_held();
/// The most of them at a time since forget_most_bytes_held().
std::int64_t most_bytes_held();
void forget_most_bytes_held();

}  // namespace etendue
