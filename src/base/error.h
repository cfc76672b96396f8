#pragma once

#include <stdexcept>
#include <string>

namespace etendue {

/// What kind of thing went wrong; the command line maps it to its documented exit code.
enum class Failure {
  internal,  ///< a defect of ours
  usage,     ///< the request makes no sense (unknown flag, impossible size)
  input,     ///< a file that was to be read is missing, damaged or wrong
  output,    ///< a file could not be written
};

/// An error that ends the operation. The message is one finished sentence for a person: what, where, and the remedy.
class Error : public std::runtime_error {
 public:
  Error(Failure failure, const std::string& message) : std::runtime_error(message), failure_(failure) {}
  Failure failure() const { return failure_; }

 private:
  Failure failure_;
};

}  // namespace etendue
