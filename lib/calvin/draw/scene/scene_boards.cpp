// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lays a sheet, and what is printed on it, where a board was.

#include "calvin/draw/scene/scene_boards.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/geometry/se3.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

constexpr SceneColour kPaper = {0.90, 0.92, 0.94, 1};
constexpr int kMostSquares = 400;  // of a board; a finer one is a sheet with its rim

class BoardMaker {
 public:
  // `strength`: 1 for a board alone, less where there are many.
  BoardMaker(const Board& board, const SE3& pose, double strength, Scene& to)
      : pose_(pose), strength_(strength), to_(to) {
    const BoardArea sheet = board.outline();
    add(sheet, 0.20, true);
    add(sheet, 0.75, false);
    const auto grid = board.grid();
    if (!grid || grid->count() > kMostSquares) return;
    if (board.as<Checkerboard>() != nullptr) {
      add_squares(*grid);
    } else {
      add_lines(*grid);
    }
  }

 private:
  void add(const BoardArea& area, double alpha, bool is_filled) {
    ScenePath path;
    for (const auto& [x, y] :
         {std::pair(area.left, area.top), std::pair(area.right, area.top),
          std::pair(area.right, area.bottom), std::pair(area.left, area.bottom)}) {
      path.points.push_back(pose_ * Eigen::Vector3d(x, y, 0));
    }
    path.colour = kPaper;
    path.colour.alpha = strength_ * alpha;
    path.is_closed = true;
    path.is_filled = is_filled;
    to_.paths.push_back(std::move(path));
  }

  // Every second one, those around the control points too.
  void add_squares(const Grid& grid) {
    constexpr double kAlpha = 0.45;
    for (int row = -1; row < grid.rows; ++row) {
      for (int col = -1; col < grid.cols; ++col) {
        if ((row + col) % 2 != 0) continue;
        add({grid.distance_to(col), grid.distance_to(row), grid.distance_to(col + 1),
             grid.distance_to(row + 1)},
            kAlpha, true);
      }
    }
  }

  void add_lines(const Grid& grid) {
    constexpr double kAlpha = 0.4;
    const double right = grid.distance_to(grid.cols - 1);
    const double bottom = grid.distance_to(grid.rows - 1);
    for (int row = 0; row < grid.rows; ++row) {
      const double y = grid.distance_to(row);
      add({0, y, right, y}, kAlpha, false);
    }
    for (int col = 0; col < grid.cols; ++col) {
      const double x = grid.distance_to(col);
      add({x, 0, x, bottom}, kAlpha, false);
    }
  }

  SE3 pose_;
  double strength_;
  Scene& to_;
};

}  // namespace

void add_boards(const Rig& rig, Scene& to) {
  constexpr double kWholly = 3;  // boards
  const double strength =
      std::min(1.0, kWholly / std::max<double>(1, static_cast<double>(rig.boards.size())));
  std::optional<Eigen::Vector3d> labelled;
  int drawn = 0;
  for (const RigBoard& shown : rig.boards) {
    const auto board = parse_board(shown.board);
    if (!board) continue;
    const SE3 pose = to_se3(shown.rig_from_board);
    BoardMaker(*board, pose, strength, to);
    ++drawn;
    const BoardArea sheet = board->outline();
    if (!labelled) labelled = pose * Eigen::Vector3d(sheet.right, sheet.top, 0);
  }
  if (!labelled) return;
  to.labels.push_back({*labelled, drawn == 1 ? "board" : "boards", kPaper});
}

}  // namespace calvin
