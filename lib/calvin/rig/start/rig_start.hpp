// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The first places of all cameras and boards: along the tree of the best links. Internal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/rig/board_views.hpp"
#include "calvin/rig/start/links.hpp"

namespace calvin::rig {

// A view in the least squares: which board at which instant it shows, and how its labels lie.
struct PlacedView {
  std::size_t view = 0;
  std::size_t pose = 0;  // the number of rig_from_board
  SE3 board_from_own;    // of the labels of the board's pose and of this view
};

struct RigPlaces {
  std::vector<SE3> camera_from_rig;  // the first camera is the rig
  std::vector<SE3> rig_from_board;   // of each board at each instant
  std::vector<PlacedView> views;
};

// The cameras that can be placed together: of the sets that decided links join the largest, of two
// as large that with the camera that is listed first.
struct JoinedCameras {
  std::vector<bool> is_joined;
  std::vector<std::string> why_not;  // a sentence for each camera that is not
};
[[nodiscard]] JoinedCameras joined_cameras(const std::vector<Link>& links,
                                           const std::vector<std::string>& names);

// kDegenerate where cameras are joined to the others by no link, and where a link that is needed is
// not decided; the message names them and says what to show. `names` are those of the cameras. A
// board that fewer than `fewest` views of an instant show is left out.
[[nodiscard]] Result<RigPlaces> place_all(const std::vector<BoardView>& views,
                                          const std::vector<std::vector<std::size_t>>& groups,
                                          const std::vector<Camera>& cameras,
                                          const std::vector<Link>& links,
                                          const std::vector<std::string>& names,
                                          std::size_t fewest = 2);

}  // namespace calvin::rig
