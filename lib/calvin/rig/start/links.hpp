// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where two cameras stand to each other, by what both have seen: every tilt of a plane and every
// labelling of a board is tried, and all instants vote. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/board_views.hpp"

namespace calvin::rig {

// One board that both cameras have seen at one time: numbers of views.
struct CommonView {
  std::size_t a = 0;
  std::size_t b = 0;
};

struct Link {
  std::size_t a = 0;  // cameras, a < b
  std::size_t b = 0;
  std::vector<CommonView> common;
  SE3 b_from_a;
  std::size_t votes = 0;     // of the common views, those that agree
  bool is_decided = true;    // else another place of the cameras agrees with the views as well
  bool is_mirrored = false;  // not decided, as the pictures of one of the two are mirrored
};

// For each pair of cameras that have seen a board at one time. `groups` are the views of each
// instant.
[[nodiscard]] std::vector<Link> find_links(const std::vector<BoardView>& views,
                                           const std::vector<std::vector<std::size_t>>& groups,
                                           const std::vector<Camera>& cameras);

// The motion a_from_b of the frames of a board between the labellings of two views, and the pose of
// the first one, under which a place of the cameras explains both best.
struct Agreement {
  SE3 pose;           // camera_from_board of the first, by its own labelling
  SE3 labelling;      // first_from_second
  double misfit = 0;  // px, of the second
};
[[nodiscard]] Agreement agreement(const BoardView& first, const BoardView& second,
                                  const CameraPoints& second_camera, const SE3& second_from_first);
// The same for one pose of the first.
[[nodiscard]] Agreement agreement(const BoardView& first, const SE3& pose, const BoardView& second,
                                  const CameraPoints& second_camera, const SE3& second_from_first);

}  // namespace calvin::rig
