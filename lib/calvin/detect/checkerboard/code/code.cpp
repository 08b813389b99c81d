// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The code of a board by its kind.

#include "calvin/detect/checkerboard/code/code.hpp"

#include "calvin/detect/checkerboard/code/april_code.hpp"
#include "calvin/detect/checkerboard/code/charuco_code.hpp"
#include "calvin/detect/checkerboard/code/circle_code.hpp"
#include "calvin/detect/checkerboard/code/puzzle_code.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

std::shared_ptr<const Code> code_of(const Board& board) {
  if (const auto* puzzle = board.as<PuzzleBoard>()) return std::make_shared<PuzzleCode>(*puzzle);
  if (const auto* charuco = board.as<CharucoBoard>()) {
    return std::make_shared<CharucoCode>(*charuco);
  }
  if (const auto* marked = board.as<MarkedCheckerboard>()) {
    return std::make_shared<CircleCode>(*marked);
  }
  if (const auto* april = board.as<AprilGrid>()) return std::make_shared<AprilCode>(*april);
  return nullptr;
}

}  // namespace calvin::detect
