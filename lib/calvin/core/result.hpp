// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Result<T>: a value or an Error that says what to do. No exception leaves the library.
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace calvin {

enum class ErrorCode {
  kInvalidArgument,  // the caller's text, option or number is wrong
  kNotFound,         // a file or a name does not exist
  kIo,               // the system refused to read or write
  kMalformed,        // the content of a file is broken
  kUnsupported,      // understood, but this build or version cannot do it
  kDegenerate,       // the data do not determine the answer
  kCancelled,        // a stop was requested
};

// `message` is one or more whole sentences for the user: what is wrong, where, and what to do.
struct Error {
  ErrorCode code = ErrorCode::kInvalidArgument;
  std::string message;
};

template <typename T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

// `return make_error(ErrorCode::kMalformed, "...");` from a function that returns any Result<T>.
[[nodiscard]] inline tl::unexpected<Error> make_error(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace calvin
