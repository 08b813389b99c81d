// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The kinds of boards, for whoever treats them differently. Not installed: a program that uses the
// library asks the Board.
#pragma once

#include <variant>

#include "calvin/target/april_grid.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/charuco_board.hpp"
#include "calvin/target/checkerboard.hpp"
#include "calvin/target/circle_grid.hpp"
#include "calvin/target/point_board.hpp"
#include "calvin/target/point_light.hpp"
#include "calvin/target/puzzle_board.hpp"
#include "calvin/target/tag_grid.hpp"
#include "calvin/target/tag_list.hpp"
#include "calvin/target/unbounded_grid.hpp"

namespace calvin {

// A new kind is a file in target/, a name here and a line in board.cpp.
struct Board::Kind : std::variant<Checkerboard, MarkedCheckerboard, PuzzleBoard, CharucoBoard,
                                  AprilGrid, CircleGrid, AsymmetricCircleGrid, TagGrid, TagList,
                                  UnboundedGrid, PointBoard, PointLight> {
  using variant::variant;
};

template <typename OneKind>
const OneKind* Board::as() const noexcept {
  return std::get_if<OneKind>(kind_.get());
}

}  // namespace calvin
