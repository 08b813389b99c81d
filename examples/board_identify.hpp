// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-board identify: which boards pictures show.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/result.hpp"
#include "calvin/detect/identify.hpp"
#ifdef BOARD_OPENCV
#include "read_picture.hpp"
#endif

namespace board_identify {

// Prints a line for each board in a picture, with squares of `side` m. Returns whether there was
// one.
inline calvin::Result<bool> identify(const std::string& file, double side) {
#ifdef BOARD_OPENCV
  const cv::Mat picture = read_picture(file);
  if (picture.empty()) {
    if (const auto there = calvin::read_file(file); !there) {
      return tl::unexpected<calvin::Error>(there.error());
    }
    return calvin::make_error(
        calvin::ErrorCode::kNotFound,
        fmt::format("'{}' is no picture that can be read: give it a PNG or JPEG file.", file));
  }
  const auto seen = calvin::identify_boards(
      {picture.data, picture.cols, picture.rows, static_cast<std::ptrdiff_t>(picture.step[0]), 1},
      side);
  for (const calvin::IdentifiedBoard& one : seen) {
    fmt::print("{}: {}{}{}\n", file, one.board.text(), one.whole ? "" : ", or a part of it",
               one.mirrored ? ", in a mirror" : "");
  }
  if (seen.empty()) fmt::print("{}: no board that can be named is seen\n", file);
  return !seen.empty();
#else
  return calvin::make_error(
      calvin::ErrorCode::kUnsupported,
      fmt::format("'{}' cannot be read: this program was built without OpenCV, which reads "
                  "pictures (squares of {} m were meant).",
                  file, side));
#endif
}

}  // namespace board_identify
