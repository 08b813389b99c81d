// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-show CALIBRATION [TRUTH]: prints a calibration of any known format, with the sigmas, and
// beside a second one where the truth is known.
#include <cstdio>
#include <string_view>

#include <fmt/format.h>

#include "calvin/io/calibration_io.hpp"
#include "print_calibration.hpp"

int main(int argc, char** argv) {
  const bool help =
      argc == 2 && (std::string_view(argv[1]) == "--help" || std::string_view(argv[1]) == "-h");
  if (help || argc < 2 || argc > 3) {
    fmt::print(help ? stdout : stderr,
               "usage: calvin-show CALIBRATION [TRUTH]\n"
               "Prints a calibration, beside another one where the truth is known. "
               "calvin-compare tells how far two calibrations are apart.\n");
    return help ? 0 : 2;
  }
  const auto calibration = calvin::read_calibration(argv[1]);
  if (!calibration) {
    fmt::print(stderr, "{}\n", calibration.error().message);
    return 1;
  }
  if (argc == 2) {
    calvin_tools::print(*calibration);
    return 0;
  }
  const auto truth = calvin::read_calibration(argv[2]);
  if (!truth) {
    fmt::print(stderr, "{}\n", truth.error().message);
    return 1;
  }
  calvin_tools::print(*calibration, &*truth);
  return 0;
}
