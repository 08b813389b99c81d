// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The entry point for libFuzzer: one program for all targets.
//   CALVIN_TARGET=key_list fuzz NEW-INPUTS corpus/key_list

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include <gst/gst.h>

#include "targets.hpp"

static const calvin::fuzz::Target* target;

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  gst_init(argc, argv);
  const char* name = std::getenv("CALVIN_TARGET");
  target = calvin::fuzz::find_target(name != nullptr ? name : "");
  if (target != nullptr) return 0;
  std::fprintf(stderr, "CALVIN_TARGET must be one of:");
  for (const auto& t : calvin::fuzz::targets()) std::fprintf(stderr, " %s", t.name.data());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target->run({reinterpret_cast<const char*>(data), size});
  return 0;
}
