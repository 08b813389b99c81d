// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is printed around the corners of a board of each kind.

#include "calvin/detect/checkerboard/code/pattern.hpp"

#include <utility>

#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

Surroundings surroundings_of(const Board& board) {
  Surroundings all;
  if (board.as<PuzzleBoard>() != nullptr) {
    all.along = 0.5F - 0.5F * static_cast<float>(PuzzleBoard::kDotDiameter);
  }
  if (const auto* charuco = board.as<CharucoBoard>()) {
    all.aside = static_cast<float>(0.5 * (1 - charuco->marker / charuco->square));
  }
  if (const auto* april = board.as<AprilGrid>()) {
    const double border = april->border / (april->dictionary->side + 2.0 * april->border);
    all.gap = static_cast<float>(april->grid().gap_share());
    all.aside = static_cast<float>(border / april->spacing);
  }
  return all;
}

// In every other square of a ChArUco board, and in one of four of an AprilGrid, one for two cells
// of the marker.
int code_corners_of(const Board& board) {
  if (const auto* april = board.as<AprilGrid>()) {
    return april->dictionary->side * april->dictionary->side / 8;
  }
  const auto* charuco = board.as<CharucoBoard>();
  return charuco == nullptr ? 0 : charuco->dictionary->side * charuco->dictionary->side / 4;
}

}  // namespace

Pattern::Pattern(Board of)
    : board(std::move(of)),
      grid(board.grid().value_or(Grid{})),
      surroundings(surroundings_of(board)),
      code(code_of(board)),
      code_corners(code_corners_of(board)) {}

bool has_pattern(const Board& board) {
  return board.as<Checkerboard>() != nullptr || board.as<MarkedCheckerboard>() != nullptr ||
         board.as<PuzzleBoard>() != nullptr || board.as<CharucoBoard>() != nullptr ||
         board.as<AprilGrid>() != nullptr;
}

}  // namespace calvin::detect
