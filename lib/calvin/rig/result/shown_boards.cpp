// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Takes the place that is farthest from those that were taken before, until there are enough.

#include "calvin/rig/result/shown_boards.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

#include <Eigen/Core>

namespace calvin::rig {

namespace {

constexpr std::size_t kMostShown = 24;

struct Shown {
  const Board* board = nullptr;
  SE3 rig_from_board;
  Eigen::Vector3d middle;  // m, rig
};

std::vector<Shown> all_shown(const std::vector<RigCameraViews>& seen,
                             const std::vector<BoardView>& views, const RigPlaces& places) {
  std::set<std::pair<std::size_t, std::size_t>> is_there;  // poses and boards
  std::vector<Shown> all;
  for (const PlacedView& placed : places.views) {
    if (!is_there.insert({placed.pose, views[placed.view].own_board}).second) continue;
    const RigView& of = views[placed.view].of;
    const Board& board = seen[of.camera].views[of.view].board;
    const SE3 pose = places.rig_from_board[placed.pose] * placed.board_from_own;
    const BoardArea extent = board.extent();
    const Eigen::Vector3d middle(0.5 * (extent.left + extent.right),
                                 0.5 * (extent.top + extent.bottom), 0);
    all.push_back({&board, pose, pose * middle});
  }
  return all;
}

// Ascending numbers in `all`.
std::vector<std::size_t> spread(const std::vector<Shown>& all) {
  std::vector<std::size_t> taken;
  std::vector<double> away(all.size(), 1e300);  // m, from the nearest one that was taken
  std::size_t next = 0;
  while (taken.size() < std::min(kMostShown, all.size())) {
    taken.push_back(next);
    for (std::size_t i = 0; i < all.size(); ++i) {
      away[i] = std::min(away[i], (all[i].middle - all[next].middle).norm());
    }
    away[next] = -1;
    next = static_cast<std::size_t>(std::ranges::max_element(away) - away.begin());
  }
  std::ranges::sort(taken);
  return taken;
}

}  // namespace

std::vector<RigBoard> shown_boards(const std::vector<RigCameraViews>& seen,
                                   const std::vector<BoardView>& views, const RigPlaces& places,
                                   double scale) {
  const std::vector<Shown> all = all_shown(seen, views, places);
  std::vector<RigBoard> boards;
  for (const std::size_t i : spread(all)) {
    SE3 pose = all[i].rig_from_board;
    pose.translation *= scale;
    boards.push_back({all[i].board->text(), to_pose(pose)});
  }
  return boards;
}

}  // namespace calvin::rig
