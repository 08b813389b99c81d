// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lays a sheet, and what is printed on it, where a board was.

#include "calvin/draw/scene/scene_boards.hpp"

#include <algorithm>
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

// How a board is drawn.
enum class Look {
  kWhole,  // with what is printed on it
  kSheet,  // its rim, and a breath of the sheet: many of them hide each other
};

class BoardMaker {
 public:
  BoardMaker(const Board& board, const SE3& pose, Look look, Scene& to) : pose_(pose), to_(to) {
    const BoardArea sheet = board.outline();
    const bool is_whole = look == Look::kWhole;
    add(sheet, is_whole ? 0.22 : 0.035, true);
    add(sheet, is_whole ? 0.95 : 0.40, false);
    const auto grid = board.grid();
    if (!is_whole || !grid || grid->count() > kMostSquares) return;
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
    path.colour.alpha = alpha;
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
  Scene& to_;
};

struct Shown {
  Board board;
  SE3 pose;
  Eigen::Vector3d middle;  // m, rig
};

}  // namespace

void add_boards(const Rig& rig, Scene& to) {
  std::vector<Shown> all;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const RigBoard& shown : rig.boards) {
    const auto board = parse_board(shown.board);
    if (!board) continue;
    const BoardArea sheet = board->outline();
    const SE3 pose = to_se3(shown.rig_from_board);
    all.push_back({*board, pose,
                   pose * Eigen::Vector3d(0.5 * (sheet.left + sheet.right),
                                          0.5 * (sheet.top + sheet.bottom), 0)});
    sum += all.back().middle;
  }
  if (all.empty()) return;
  const Eigen::Vector3d mean = sum / static_cast<double>(all.size());
  const auto whole = std::ranges::min_element(
      all, {}, [&](const Shown& one) { return (one.middle - mean).squaredNorm(); });
  for (auto one = all.begin(); one != all.end(); ++one) {
    BoardMaker(one->board, one->pose, one == whole ? Look::kWhole : Look::kSheet, to);
  }
  const BoardArea sheet = whole->board.outline();
  to.labels.push_back(
      {whole->pose * Eigen::Vector3d(sheet.right, sheet.top, 0),
       all.size() == 1 ? "board" : fmt::format("board, {} of its places", all.size()), kPaper});
}

}  // namespace calvin
