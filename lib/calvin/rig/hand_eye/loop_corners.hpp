// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corners of all loops, with the labels of one board, and which of them count. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/rig/board_views.hpp"
#include "calvin/rig/hand_eye/problem.hpp"

namespace calvin::rig {

// What one camera has seen of the board.
struct SeenBoard {
  const BoardView* view = nullptr;
  SE3 board_from_own;     // of the labels of the board and of the view
  SE3 camera_from_board;  // by the corners of the view alone
};

// The points with the labels of the board, rows farther apart by `aspect`.
[[nodiscard]] PointSet with_labels(const SeenBoard& seen, double aspect);

// What was seen at one pose of the robot, by one camera or several, where the board is before the
// first camera, about, and what the robot told.
struct LoopView {
  std::vector<SeenBoard> seen;
  SE3 camera_from_board;
  SE3 base_from_hand;
};

// The cameras on one mount. The first one is where HandEyePlaces has the camera.
struct MountedCameras {
  std::vector<Camera> cameras;
  std::vector<SE3> camera_from_first;
};

// Where corners are expected.
struct LoopGeometry {
  const MountedCameras& mounted;
  const std::vector<SE3>& camera_from_board;  // of every loop
  double aspect = 1;  // of the board: how much farther apart its rows are than its columns
};

class LoopCorners {
 public:
  // With `has_aspect` the points of the arrays have it as their one mode.
  LoopCorners(const std::vector<LoopView>& loops, bool has_aspect);

  // Leaves out the corners that are far off what the others say, and no others: those of the same
  // view, or of all.
  struct Kept {
    double sigma = 0;      // px, of a corner with the weight 1; 0 where no corner is seen
    bool changed = false;  // others count than before
  };
  Kept leave_out_by_views(const std::vector<Camera>& cameras);
  Kept leave_out(const LoopGeometry& geometry);

  // The corners in use of one loop, for a problem, and how many there are.
  [[nodiscard]] std::vector<SeenByCamera> seen(std::size_t loop) const;
  [[nodiscard]] std::size_t count(std::size_t loop) const;

  // Of the corners in use of some loops, not weighted, px: root mean square distances, of each
  // camera by itself and of all.
  struct Rms {
    std::vector<double> of_cameras;
    double all = 0;
  };
  [[nodiscard]] Rms rms(const LoopGeometry& geometry, const std::vector<bool>& used) const;

 private:
  struct Set {
    std::size_t loop = 0;
    std::size_t camera = 0;
    SE3 by_view;  // camera_from_board
    PointSet all;
    PointSet used;  // those that are left out have the weight 0
  };
  // `far` are the distances of all corners of each set.
  Kept leave_out(const std::vector<std::vector<double>>& far);
  void make_arrays();

  bool has_aspect_;
  std::vector<Set> sets_;  // by loop
  std::vector<ViewPoints> points_;
};

}  // namespace calvin::rig
