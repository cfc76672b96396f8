#pragma once

#include <gtest/gtest.h>

#include <string>

#include "base/error.h"

namespace etendue {

/// The message of the output error that `action` throws; empty if it throws none.
template <typename Action>
std::string output_failure(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.failure(), Failure::output) << error.what();
    return error.what();
  }
  return {};
}

}  // namespace etendue
