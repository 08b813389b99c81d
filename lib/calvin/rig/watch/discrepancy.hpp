// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What two cameras that see one board at one time say against a rig that is known. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/board_views.hpp"
#include "calvin/rig/joint/pose_covariance.hpp"

namespace calvin::rig {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Where one view has its board: the best pose, and the other tilt of the plane where that fits
// nearly as well.
struct MeasuredPose {
  struct Choice {
    SE3 camera_from_board;
    PoseCovariance covariance;
  };
  std::vector<Choice> choices;  // empty: the view says nothing
  std::vector<SE3> labellings;  // as BoardView has them
};
[[nodiscard]] MeasuredPose measure_pose(const BoardView& view, const Calibration& calibration,
                                        const Camera& camera);

// From where the rig has the second camera to where it stands by the board that both see and by the
// place of the first: its turn about the axes of the rig (rad), then its place (m).
struct Discrepancy {
  Vector6 change = Vector6::Zero();
  Matrix6 of_noise = Matrix6::Zero();   // covariance by this instant alone
  Matrix6 in_common = Matrix6::Zero();  // by the rig and by the lenses, for all instants alike

  // e^T C^-1 e / 6: about 1 where the rig is right.
  [[nodiscard]] double square() const;
};

// Of all tilts and labellings the one that contradicts the rig least. Covariances of the rig's
// cameras count as independent. Absent where a view says nothing.
[[nodiscard]] std::optional<Discrepancy> discrepancy(const RigCamera& first,
                                                     const MeasuredPose& by_first,
                                                     const RigCamera& second,
                                                     const MeasuredPose& by_second);

// e^T C^-1 e / 6; 0 where that is no number.
[[nodiscard]] double normalised_square(const Vector6& change, const Matrix6& covariance);

}  // namespace calvin::rig
