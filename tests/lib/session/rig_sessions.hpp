// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A session of a stereo rig, and what its cameras tell it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "calvin/session/rig/rig_session.hpp"
#include "simulated_rig.hpp"

namespace calvin::scenes {

inline constexpr std::uint64_t kFrame = 33'000'000;  // ns

// What a session is told of a solve.
inline std::shared_ptr<const WatchedRig> watched(const RigJob& job, const RigSolution& solved) {
  return std::make_shared<const WatchedRig>(watched_rig(solved.rig, views_of(job), job.options));
}

// A session of a stereo rig whose cameras are known.
struct Sessions {
  explicit Sessions(RigMode mode = RigMode::kJoint, std::uint64_t tolerance = 10'000'000) {
    Random random(1);
    rig = stereo_rig(random);
    RigSessionSettings settings;
    settings.options = {mode, tolerance};
    session.start(settings);
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      session.set_name(c, "cam" + std::to_string(c));
      session.set_intrinsics(c, rig.cameras[c].to_calibration());
    }
  }
  // What a camera sees of a board at a time, if it sees it.
  std::optional<Observation> seen(std::size_t camera, const SE3& world_from_board,
                                  std::uint64_t timestamp) {
    const SE3 pose = rig.world_from_camera[camera].inverse() * world_from_board;
    if (!faces(pose) || !sees_all(rig.cameras[camera], rig.board, pose)) {
      return std::nullopt;
    }
    View view = observe(rig.cameras[camera], rig.board, pose, rig.noise, noise);
    view.observation.timestamp = timestamp;
    return view.observation;
  }
  bool offer(std::size_t camera, const SE3& world_from_board, std::uint64_t timestamp) {
    const auto observation = seen(camera, world_from_board, timestamp);
    return observation && session.offer(camera, *observation).value();
  }
  SimulatedRig rig;
  RigSession session;
  Random noise{7};
};

}  // namespace calvin::scenes
