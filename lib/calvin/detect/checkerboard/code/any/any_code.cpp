// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads a lattice in the manner of one kind of board after the other.

#include "calvin/detect/checkerboard/code/any/any_code.hpp"

#include <memory>
#include <utility>
#include <vector>

#include "calvin/detect/checkerboard/code/any/charuco_boards.hpp"
#include "calvin/detect/checkerboard/code/april_code.hpp"
#include "calvin/detect/checkerboard/code/circle_code.hpp"
#include "calvin/detect/checkerboard/code/puzzle_code.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

constexpr int kMostCorners = 30;  // along a side of a board
constexpr int kMostTags = 10;
// What a ChArUco board with the largest markers leaves free.
constexpr float kNarrowest = 0.05F;  // of a square's side

std::optional<Board> find_puzzle_board(const ImageView& image, const Lattice& lattice,
                                       double square) {
  const PuzzleCode code(PuzzleBoard{3, 3, square});
  std::vector<CodeBit> bits;
  code.read(image, lattice, bits);
  return code.other_board(image, lattice, bits, false);
}

std::optional<Board> find_april_grid(const ImageView& image, const Lattice& lattice,
                                     const Grid& like) {
  for (const MarkerDictionary& dictionary : marker_dictionaries()) {
    if (!dictionary.name.starts_with("DICT_APRILTAG")) continue;
    for (const int border : {2, 1}) {
      const AprilCode code(AprilGrid{2, 2, like.pitch, like.gap / like.pitch, &dictionary, border});
      std::vector<CodeBit> bits;
      code.read(image, lattice, bits);
      if (const auto board = code.grid_of(bits)) return *board;
    }
  }
  return std::nullopt;
}

}  // namespace

AnyCode::AnyCode(const Grid& grid) : Code(grid, 1, 1, true), grid_(grid) {}

std::optional<Board> AnyCode::other_board(const ImageView& image, const Lattice& lattice,
                                          std::span<const CodeBit> /*bits*/, bool whole) const {
  if (!lattice.has_even_steps()) return find_april_grid(image, lattice, grid_);
  if (auto puzzle = find_puzzle_board(image, lattice, grid_.pitch)) return puzzle;
  if (const auto board = find_charuco_board(image, lattice, whole, grid_.pitch)) return *board;
  if (!whole) return std::nullopt;
  if (const auto marked = find_marked_checkerboard(image, lattice, grid_.pitch)) return *marked;
  return std::nullopt;
}

Pattern any_board_of_squares(double square) {
  Pattern pattern(PuzzleBoard{kMostCorners, kMostCorners, square});
  pattern.surroundings.aside = kNarrowest;
  pattern.code = std::make_shared<AnyCode>(pattern.grid);
  return pattern;
}

std::optional<Pattern> any_april_grid(double tag, double spacing) {
  const MarkerDictionary* family = find_dictionary(AprilGrid::kUsualFamily);
  if (family == nullptr) return std::nullopt;
  Pattern pattern(AprilGrid{kMostTags, kMostTags, tag, spacing, family, 1});
  pattern.code = std::make_shared<AnyCode>(pattern.grid);
  return pattern;
}

}  // namespace calvin::detect
