// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards that are fixed to each other, as on the faces of a box: cameras that never see one and the
// same board are joined by them. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/board_views.hpp"

namespace calvin::rig {

// Where a board is on its rigid body, whose frame is that of its first board.
struct BoardOnBody {
  std::size_t body = 0;  // number of that first board
  SE3 body_from_board;
  bool is_seen_with_others = false;  // in one picture of one camera
  bool is_decided = true;            // else pictures leave open how it lies to another one
};

// Of every board of the views, by its number. Boards are joined where one camera has seen two of
// them in one picture, by a vote of all such pictures, along the tree of the best pairs; a board
// that nothing joins is a body of its own.
[[nodiscard]] std::vector<BoardOnBody> boards_on_bodies(const std::vector<BoardView>& views,
                                                        const std::vector<RigCameraViews>& seen,
                                                        const std::vector<Camera>& cameras);

// The views as views of bodies: what board is shown is one more labelling of its body.
[[nodiscard]] std::vector<BoardView> views_of_bodies(const std::vector<BoardOnBody>& boards,
                                                     const std::vector<BoardView>& views);

}  // namespace calvin::rig
