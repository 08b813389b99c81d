// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The choice of the detector by the kind of the board.

#include "calvin/detect/detector.hpp"

#include <vector>

#include <fmt/format.h>

#include "calvin/detect/checkerboard/sheets/checkerboard_detector.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

Result<Checkerboard> as_checkerboard(const Board& board) {
  const auto* checkerboard = board.as<Checkerboard>();
  if (checkerboard == nullptr) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("The board {} cannot be detected: there is no detector for boards "
                    "of its kind. Give its corners as a file of observations.",
                    board.text()));
  }
  // Two lines of corners have no curvature, and are in any pattern of bricks.
  if (checkerboard->cols < 3 || checkerboard->rows < 3) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("The board {} cannot be detected: at least 3x3 inner corners are "
                                  "needed.",
                                  board.text()));
  }
  return *checkerboard;
}

}  // namespace

Result<std::unique_ptr<Detector>> make_detector(std::span<const Board> boards) {
  if (boards.empty()) {
    return make_error(ErrorCode::kInvalidArgument, "There is no board to detect: name one.");
  }
  std::vector<Checkerboard> checkerboards;
  for (const Board& board : boards) {
    const auto checkerboard = as_checkerboard(board);
    if (!checkerboard) return tl::unexpected<Error>(checkerboard.error());
    checkerboards.push_back(*checkerboard);
  }
  return detect::make_checkerboard_detector(checkerboards);
}

Result<std::unique_ptr<Detector>> make_detector(const Board& board) {
  return make_detector(std::span(&board, 1));
}

}  // namespace calvin
