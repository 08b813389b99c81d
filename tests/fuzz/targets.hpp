// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is fuzzed: one function per parser. Each takes any bytes and ends the process where a
// promise of the parser is broken; bytes that are refused with a message are fine.
#pragma once

#include <span>
#include <string_view>

namespace calvin::fuzz {

struct Target {
  std::string_view name;  // also the folder of its corpus
  void (*run)(std::string_view bytes);
};

[[nodiscard]] std::span<const Target> targets();

// nullptr where there is none of that name.
[[nodiscard]] const Target* find_target(std::string_view name);

}  // namespace calvin::fuzz
