// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Frames and cameras of a result.

#include "calvin/rig/result/rig_result.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "calvin/geometry/dense.hpp"
#include "calvin/rig/pose_unknowns.hpp"

namespace calvin::rig {

void set_cameras(const std::vector<Calibration>& cameras, const PlacedCameras& frames,
                 const std::vector<double>& rms, Rig& to) {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    RigCamera& camera = to.cameras.emplace_back();
    camera.calibration = cameras[c];
    camera.rms = rms[c];
  }
  set_places(frames, to.cameras);
}

void set_places(const PlacedCameras& frames, std::vector<RigCamera>& cameras) {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    RigCamera& camera = cameras[c];
    camera.rig_from_camera = to_pose(frames.rig_from_camera[c]);
    for (double& x : camera.rig_from_camera.translation) x += 0.0;  // no -0 of the first camera
    const auto at = kPose * static_cast<Eigen::Index>(c);
    const Eigen::MatrixXd own = frames.covariance.block(at, at, kPose, kPose);
    camera.covariance = own.isZero(0) ? std::vector<double>() : row_major(own);
  }
}

std::optional<std::string> contradiction_remark(const Rig& rig) {
  constexpr double kAtAll = 2;       // px
  constexpr double kMuchWorse = 10;  // times what the lenses alone leave
  double alone = 0;
  for (const RigCamera& camera : rig.cameras) {
    alone = std::max(alone, camera.calibration.rms.value_or(0));
  }
  const double rms = rig.rms.value_or(0);
  if (rms < std::max(kAtAll, kMuchWorse * alone)) return std::nullopt;
  return fmt::format(
      "The views do not fit together: corners are {:.2g} px (RMS) from where the rig has them. See "
      "that all cameras show the same board at the same time, that their clocks are one, and that "
      "their intrinsics are those of the lenses as they stand.",
      rms);
}

}  // namespace calvin::rig
