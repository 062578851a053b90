// How phront reports failure: expected-style results, one enum of stable codes, one clear sentence.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace phront {

/// Stable, tested. The command line maps them to exit codes.
enum class ErrorCode {
  Failed,           ///< the operation was tried and gave nothing usable
  InvalidArgument,  ///< an option or input value outside its stated range
  UnreadableInput,  ///< a file or shape that cannot be read or holds no usable geometry
  CannotWrite,      ///< the output cannot be written
  NotSupported,     ///< outside what this version does
  ResourceLimit,    ///< a time or memory limit was reached
  Cancelled,        ///< the progress callback asked to stop
  OutOfTolerance,   ///< finished, but the result misses its tolerance or contract
};

/// One failure: a sentence that says what, where and, if there is one, the remedy.
struct Error {
  ErrorCode code = ErrorCode::Failed;
  std::string message;
  std::string where;  ///< face, edge, point or file; empty when the sentence already says it
};

template <class T>
using Result = tl::expected<T, Error>;

/// Shorthand for `return fail(ErrorCode::..., "...")` in a function that returns Result<T>.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message,
                                                std::string where = {}) {
  return tl::unexpected<Error>(Error{code, std::move(message), std::move(where)});
}

}  // namespace phront
