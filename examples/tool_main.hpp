// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The tools: how each of them begins and ends.
#pragma once

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "calvin/version.hpp"

namespace calvin_tools {

// What all tools answer alike, by the exit status; nothing where the tool itself is to answer, as
// to --help, which -h stands for. Other words of one dash and letters would be taken for files by
// tools that have no such options.
inline std::optional<int> answer(const char* name, int argc, char** argv) {
  constexpr int kWrongUsage = 2;
  static char help[] = "--help";
  const auto is = [&](const char* word) { return argc == 2 && std::string_view(argv[1]) == word; };
  if (is("--version")) {
    fmt::print("{} {}\n", name, calvin::library_version());
    return 0;
  }
  if (is("-h")) argv[1] = help;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word.size() < 2 || word[0] != '-' ||
        std::isalpha(static_cast<unsigned char>(word[1])) == 0) {
      continue;
    }
    fmt::print(stderr, "{}: there is no option '{}': see {} --help. A file of that name is ./{}\n",
               name, word, name, word);
    return kWrongUsage;
  }
  return std::nullopt;
}

// The exit status of a tool. What it prints is a result, too: where the standard output does not
// take it, as a file on a full disk, that is said and is a failure.
inline int run(const char* name, int (*tool)(int, char**), int argc, char** argv) {
  constexpr int kFailed = 1;
  int status = kFailed;
  std::error_code lost;
  try {
    const std::optional<int> answered = answer(name, argc, argv);
    status = answered ? *answered : tool(argc, argv);
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
