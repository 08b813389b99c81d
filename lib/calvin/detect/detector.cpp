// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The choice of the detector by the kind of the board.

#include "calvin/detect/detector.hpp"

#include <fmt/format.h>

#include "calvin/detect/checkerboard/code/pattern.hpp"
#include "calvin/detect/checkerboard/sheets/checkerboard_detector.hpp"

namespace calvin {

namespace {

Status check_detectable(const Board& board) {
  if (!detect::has_pattern(board)) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("The board {} cannot be detected: there is no detector for boards "
                    "of its kind. Give its corners as a file of observations.",
                    board.text()));
  }
  // Two lines of corners have no curvature, and are in any pattern of bricks.
  const Grid grid = board.grid().value_or(Grid{});
  if (grid.cols < 3 || grid.rows < 3) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("The board {} cannot be detected: at least 3x3 inner corners are "
                                  "needed.",
                                  board.text()));
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<Detector>> make_detector(std::span<const Board> boards) {
  if (boards.empty()) {
    return make_error(ErrorCode::kInvalidArgument, "There is no board to detect: name one.");
  }
  for (const Board& board : boards) {
    if (const Status status = check_detectable(board); !status) {
      return tl::unexpected<Error>(status.error());
    }
  }
  return detect::make_checkerboard_detector(boards);
}

Result<std::unique_ptr<Detector>> make_detector(const Board& board) {
  return make_detector(std::span(&board, 1));
}

}  // namespace calvin
