// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sightings, the start that they agree with, and whether it is one to begin with.

#include "calvin/rig/hand_eye/first_loops.hpp"

#include "calvin/rig/hand_eye/check.hpp"

namespace calvin::rig {

namespace {

constexpr double kMedianNorm = 1.5382;  // of three normal coordinates, in their sigma

tl::unexpected<Error> undecided() {
  return make_error(ErrorCode::kDegenerate,
                    "The poses of the robot and the pictures leave open where the camera is: the "
                    "board looks the same when it is turned, or it is seen from far away and flat. "
                    "Take more poses, with the board larger and tilted, or a board that names its "
                    "corners, as puzzle:14x9:20mm.");
}

}  // namespace

Result<FirstLoops> first_loops(const std::vector<const BoardView*>& views,
                               const std::vector<SE3>& base_from_hand, EyeSetup setup,
                               bool free_scale) {
  FirstLoops first;
  std::vector<Sighting>& sightings = first.sightings;
  for (std::size_t v = 0; v < views.size(); ++v) {
    sightings.push_back(sighting_of(*views[v], base_from_hand[v]));
  }
  if (const Status turned = check_turns(sightings, setup, 0); !turned) {
    return tl::unexpected<Error>(turned.error());
  }
  const auto found = find_start(sightings, setup, free_scale);
  if (const Status closed = check_loops(found, sightings, setup); !closed) {
    return tl::unexpected<Error>(closed.error());
  }
  if (!found->is_decided) return undecided();
  first.noise = {found->turn / kMedianNorm, found->place / kMedianNorm};
  first.places = found->places;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const BoardPose& pose = sightings[v].poses[found->poses[v]];
    first.loops.push_back({{{views[v], pose.board_from_own, pose.camera_from_board}},
                           pose.camera_from_board,
                           base_from_hand[v]});
  }
  return first;
}

}  // namespace calvin::rig
