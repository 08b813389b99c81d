// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The tools: how each of them begins and ends.
#pragma once

#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>

#include <fmt/format.h>

namespace calvin_tools {

// The exit status of a tool. What it prints is a result, too: where the standard output does not
// take it, as a file on a full disk, that is said and is a failure.
inline int run(const char* name, int (*tool)(int, char**), int argc, char** argv) {
  constexpr int kFailed = 1;
  int status = kFailed;
  std::error_code lost;
  try {
    status = tool(argc, argv);
  } catch (const std::system_error& error) {  // of fmt, which tells at once what is not buffered
    if (std::ferror(stdout) == 0) throw;
    lost = error.code();
  }
  if (std::fflush(stdout) != 0 && !lost) lost = {errno, std::generic_category()};
  if (!lost && std::ferror(stdout) == 0) return status;
  fmt::print(stderr, "{}: Cannot write what it prints: {}. Send it elsewhere, or make room.\n",
             name, lost ? lost.message() : "an error of the output");
  return status == 0 ? kFailed : status;
}

}  // namespace calvin_tools
