// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-show CALIBRATION [OTHER]: prints a calibration of any known format, with the sigmas and
// the verdict, and beside a second one how many sigmas each parameter is from that.
#include <cstdio>
#include <string_view>

#include <fmt/format.h>

#include "calvin/io/calibration_io.hpp"
#include "print_calibration.hpp"
#include "tool_main.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

constexpr std::string_view kUsage =
    R"(usage: calvin-show CALIBRATION [OTHER]
Prints a calibration, and how many sigmas each parameter is from another one, as the truth of calibtestsrc.
calvin-compare tells how far the two are apart in the picture.
)";

int failed(const calvin::Error& error) {
  fmt::print(stderr, "calvin-show: {}\n", error.message);
  return kFailed;
}

// Whether parameters in px can be held against each other. OpenCV's files need not tell their size.
calvin::Status check_sizes(const calvin::Calibration& a, const calvin::Calibration& b) {
  const calvin::ImageSize none = {};
  if (a.image_size == b.image_size || a.image_size == none || b.image_size == none) return {};
  return calvin::make_error(
      calvin::ErrorCode::kInvalidArgument,
      fmt::format("The calibrations are for images of {}x{} and {}x{} px, whose parameters cannot "
                  "be compared. 'calvin-compare --scale' compares them in the picture.",
                  a.image_size.width, a.image_size.height, b.image_size.width,
                  b.image_size.height));
}

int run_tool(int argc, char** argv) {
  const bool help = argc == 2 && std::string_view(argv[1]) == "--help";
  if (help || argc < 2 || argc > 3) {
    fmt::print(help ? stdout : stderr, "{}", kUsage);
    return help ? 0 : kWrongUsage;
  }
  for (int i = 1; i < argc; ++i) {
    if (!std::string_view(argv[i]).starts_with("--")) continue;
    fmt::print(stderr, "calvin-show: '{}' is no option.\n\n{}", argv[i], kUsage);
    return kWrongUsage;
  }
  const auto calibration = calvin::read_calibration(argv[1]);
  if (!calibration) return failed(calibration.error());
  if (argc == 2) {
    calvin_tools::print(*calibration);
    calvin_tools::print_verdict(*calibration);
    return 0;
  }
  const auto other = calvin::read_calibration(argv[2]);
  if (!other) return failed(other.error());
  if (const auto alike = check_sizes(*calibration, *other); !alike) return failed(alike.error());
  calvin_tools::print(*calibration, &*other);
  calvin_tools::print_verdict(*calibration);
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return calvin_tools::run("calvin-show", run_tool, argc, argv); }
