#pragma once

#include <stdexcept>
#include <string>

#include "base/diagnostics.h"

namespace etendue {

/// Thrown where an element cannot be used. Whoever reads the element above reports it and goes on with the next one,
/// so that one reading tells of all that is wrong.
class Problem : public std::runtime_error {
 public:
  Problem(const std::string& message, SourceLocation where) : std::runtime_error(message), where_(where) {}
  SourceLocation where() const { return where_; }

 private:
  SourceLocation where_;
};

}  // namespace etendue
